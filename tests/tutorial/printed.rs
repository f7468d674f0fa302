//! Whether a command prints what a page shows.

/// How far a number may be off, as a share of it. Rounding differs between
/// processors and leads chains elsewhere; what is left is Monte Carlo error,
/// below a tenth for all that the pages show. The words are to be the same.
const CHANCE: f64 = 0.1;

/// Where what is shown departs from what was printed, if it does. A line
/// `...` in what is shown stands for any lines.
pub(crate) fn difference(shown: &str, printed: &str) -> Option<String> {
    let mut rest = &tokens(printed)[..];
    for piece in pieces(shown) {
        let wanted = tokens(&piece);
        let agreed = |at: usize| {
            let both = wanted.iter().zip(&rest[at..]);
            both.take_while(|(a, b)| alike(a, b)).count()
        };
        let best = (0..=rest.len()).max_by_key(|&at| (agreed(at), !at));
        let (at, count) = best.map(|at| (at, agreed(at)))?;
        if count < wanted.len() {
            let of = |all: &[String]| {
                let from = count.saturating_sub(3).min(all.len());
                all[from..all.len().min(count + 5)].join(" ")
            };
            return Some(format!(
                "shown:   {}\nprinted: {}",
                of(&wanted),
                of(&rest[at..])
            ));
        }
        rest = &rest[at + count..];
    }
    None
}

/// What stands between lines of dots.
fn pieces(shown: &str) -> Vec<String> {
    let mut pieces = vec![String::new()];
    for line in shown.lines() {
        match (line, pieces.last_mut()) {
            ("...", _) | (_, None) => pieces.push(String::new()),
            (line, Some(piece)) => {
                piece.push_str(line);
                piece.push('\n');
            }
        }
    }
    pieces
}

/// Words and numbers. What pictures are drawn with is left out, and how long
/// it took.
fn tokens(text: &str) -> Vec<String> {
    let is_drawn = |c: char| "│┤├┬┼└─░▒▓█●◆".contains(c);
    let words = text.split_whitespace();
    let words = words.filter(|word| !word.chars().all(is_drawn));
    let words: Vec<&str> = words.collect();
    let is_time = |i: usize| words.get(i + 1) == Some(&"s,");
    let kept = words.iter().enumerate().filter(|(i, _)| !is_time(*i));
    kept.map(|(_, word)| (*word).to_owned()).collect()
}

fn alike(shown: &str, printed: &str) -> bool {
    shown == printed
        || match (number(shown), number(printed)) {
            (Some(a), Some(b)) => {
                let last = 0.1_f64.powi(digits(shown));
                (a - b).abs() <= CHANCE * a.abs() + 1.001 * last
            }
            _ => false,
        }
}

fn number(word: &str) -> Option<f64> {
    let is_mark = |c: char| "(),;:%".contains(c);
    let bare = word.trim_matches(is_mark).trim_end_matches('.');
    bare.replace('−', "-").parse().ok()
}

/// The digits behind a number's point.
fn digits(word: &str) -> i32 {
    let behind = word.split_once('.').map_or("", |(_, behind)| behind);
    let digits = behind.chars().take_while(char::is_ascii_digit);
    digits.count().try_into().unwrap_or(0)
}

#[test]
fn other_words_and_other_numbers_are_seen() {
    let printed = "mu is 0.2518 (0.2460 to\n0.2577)\n│ ●\nEnd. 0.13 s, seed 1";
    let differs = |shown: &str| difference(shown, printed).is_some();
    assert!(!differs("mu is 0.2519 (0.2460 to 0.2577)"));
    assert!(!differs("mu is\n...\nEnd. 9 s, seed 1"));
    assert!(differs("xi is 0.2518"));
    assert!(differs("mu is 0.2918"));
    assert!(differs("End.\n...\nmu is"));
    assert!(differs("mu 0.2518"));
}
