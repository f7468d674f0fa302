//! The figures of a calibration as a table in LaTeX.

use crate::report::digits::{beside, significant, whole};
use crate::report::{CalibrationReport, PROGRAM, ParameterReport};

/// A table of the parameters: symbol, unit, mean, standard deviation, 90 %
/// interval, R-hat and effective sizes of bulk and tails.
///
/// It is set with the package `booktabs`; text from outside, such as the
/// event's name, is escaped. Letters beyond ASCII are left as they are: which
/// of them can be set depends on the document's engine and fonts.
///
/// ```
/// use couloir::export::latex;
/// use couloir::report::CalibrationReport;
/// let mut report = CalibrationReport::default();
/// report.event = "50 % of {it} & $all$".to_owned();
/// let text = latex(&report);
/// assert!(text.contains(r"50 \% of \{it\} \& \$all\$"));
/// assert!(text.contains(r"\bottomrule"));
/// ```
pub fn latex(report: &CalibrationReport) -> String {
    let rows: String = report.parameters.iter().map(row).collect();
    let (event, friction) = (text(&report.event), text(&report.friction));
    let terms = text(&report.terms());
    let (noise, backend) = (text(report.errors_told()), text(&report.backend));
    let seed = report.seed;
    format!(
        r"% Written by {PROGRAM}. Needs \usepackage{{booktabs}}.
\begin{{table}}
\centering
\caption{{Posterior of {event}: {friction} friction, {noise} errors{terms}
({backend}, seed {seed}). Mean, standard deviation, 90\,\% interval,
$\widehat{{R}}$, and effective sample size of bulk and tails.}}
\label{{tab:couloir}}
\begin{{tabular}}{{llrrrrrrr}}
\toprule
Parameter & Unit & Mean & SD & 5\,\% & 95\,\% & $\widehat{{R}}$
& ESS bulk & ESS tail \\
\midrule
{rows}\bottomrule
\end{{tabular}}
\end{{table}}
"
    )
}

fn row(p: &ParameterReport) -> String {
    let near = |x: f64| number(&beside(x, p.sd));
    let cells = [
        symbol(&p.name),
        unit(&p.unit),
        near(p.mean),
        number(&significant(p.sd, 2)),
        near(p.q05),
        near(p.q95),
        number(&significant(p.rhat, 4)),
        number(&whole(p.ess_bulk)),
        number(&whole(p.ess_tail)),
    ];
    format!("{} \\\\\n", cells.join(" & "))
}

/// A number as printed, its minus and its power of ten set as mathematics.
fn number(text: &str) -> String {
    let power = text.split_once('e');
    match power {
        Some((digits, power)) => format!("${digits} \\times 10^{{{power}}}$"),
        None if text.starts_with('-') => format!("${text}$"),
        None => text.to_owned(),
    }
}

/// Greek letters that stand for themselves, and LaTeX's name of each.
const GREEK: [(&str, &str); 9] = [
    ("delta", r"\delta"),
    ("kappa", r"\kappa"),
    ("lambda", r"\lambda"),
    ("mu", r"\mu"),
    ("nu", r"\nu"),
    ("phi", r"\phi"),
    ("sigma2", r"\sigma^2"),
    ("tau", r"\tau"),
    ("xi", r"\xi"),
];

/// A parameter's symbol where it is a letter, with its index; its name in
/// typewriter letters otherwise.
fn symbol(name: &str) -> String {
    let indexed = name.strip_suffix(']').and_then(|n| n.split_once('['));
    let (base, index) = match indexed {
        Some((base, index)) => (base, format!("_{{{}}}", text(index))),
        None => (name, String::new()),
    };
    let letter = match GREEK.iter().find(|(known, _)| *known == base) {
        Some((_, letter)) => Some((*letter).to_owned()),
        None => {
            let single = base.len() == 1 && base.is_ascii();
            let single = single && base.chars().all(char::is_alphabetic);
            single.then(|| base.to_owned())
        }
    };
    match letter {
        Some(letter) => format!("${letter}{index}$"),
        None => format!(r"\texttt{{{}}}", text(name)),
    }
}

/// A unit with its exponents raised; a dash for a pure number.
fn unit(unit: &str) -> String {
    if unit == "1" {
        return "--".to_owned();
    }
    let mut out = String::new();
    let mut before = ' ';
    for c in unit.chars() {
        match c {
            digit if digit.is_ascii_digit() && before.is_alphabetic() => {
                out.push_str(&format!("$^{digit}$"));
            }
            other => out.push_str(&escaped(other)),
        }
        before = c;
    }
    out
}

/// Text from outside, on one line and without a meaning to LaTeX.
fn text(text: &str) -> String {
    text.chars().map(escaped).collect()
}

fn escaped(c: char) -> String {
    match c {
        '\\' => r"\textbackslash{}".to_owned(),
        '~' => r"\textasciitilde{}".to_owned(),
        '^' => r"\textasciicircum{}".to_owned(),
        '<' => r"\textless{}".to_owned(),
        '>' => r"\textgreater{}".to_owned(),
        '|' => r"\textbar{}".to_owned(),
        '"' => r"\symbol{34}".to_owned(),
        '{' | '}' | '$' | '&' | '#' | '_' | '%' => format!("\\{c}"),
        c if c.is_control() => " ".to_owned(),
        c => c.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(name: &str, unit: &str) -> ParameterReport {
        let mut p = ParameterReport::default();
        (p.name, p.unit) = (name.to_owned(), unit.to_owned());
        (p.mean, p.sd, p.q05, p.q95) = (-0.341_27, 0.081, -0.48, 0.02);
        (p.rhat, p.ess_bulk, p.ess_tail) = (1.000_4, 9012.4, 1e8);
        p
    }

    #[test]
    fn a_row_has_the_symbol_and_rounded_figures() {
        assert_eq!(
            row(&parameter("phi[2]", "m2/s2")),
            "$\\phi_{2}$ & m$^2$/s$^2$ & $-0.341$ & 0.081 & $-0.480$ & 0.020 \
             & 1.000 & 9012 & $1.00 \\times 10^{8}$ \\\\\n"
        );
    }

    #[test]
    fn what_does_not_exist_is_said_to() {
        let mut p = parameter("mu", "1");
        (p.rhat, p.ess_bulk) = (f64::NAN, f64::NAN);
        assert!(row(&p).contains("& n/a & n/a &"), "{}", row(&p));
    }

    #[test]
    fn symbols_are_letters_or_names() {
        let cases = [
            ("mu", r"$\mu$"),
            ("sigma2", r"$\sigma^2$"),
            ("e", "$e$"),
            ("time_ou", r"\texttt{time\_ou}"),
            ("A.mu", r"\texttt{A.mu}"),
            ("sd[1]", r"\texttt{sd[1]}"),
        ];
        for (name, expected) in cases {
            assert_eq!(symbol(name), expected);
        }
        assert_eq!(unit("1/s"), "1/s");
    }

    /// Whether a text would end a group, a line or a cell that it stands in.
    fn breaks_out(text: &str) -> bool {
        let mut depth = 0;
        let mut chars = text.chars();
        while let Some(c) = chars.next() {
            match c {
                // A command of one character, or the first of a word.
                '\\' => match chars.next() {
                    Some('\\') | None => return true,
                    Some(_) => {}
                },
                '{' => depth += 1,
                '}' if depth == 0 => return true,
                '}' => depth -= 1,
                '$' | '&' | '#' | '_' | '%' | '^' | '~' => return true,
                c if c.is_control() => return true,
                _ => {}
            }
        }
        depth != 0
    }

    proptest::proptest! {
        #[test]
        fn no_name_breaks_out_of_its_cell(
            name in r#"[\\{}$&#_%^~<>|"\x00-\x20a-zé]{0,12}"#
        ) {
            proptest::prop_assert!(!breaks_out(&text(&name)), "{name:?}");
        }
    }

    #[test]
    fn what_would_break_out_is_seen() {
        for bad in ["}", "{", "a & b", r"\\", "50 %", "a\nb", r"\"] {
            assert!(breaks_out(bad), "{bad:?}");
        }
    }

    #[test]
    fn the_name_of_an_event_stays_within_the_caption() {
        let report = CalibrationReport {
            event: "}\\end{table}\n\\input{/etc/passwd}%".to_owned(),
            parameters: vec![parameter("mu", "1")],
            ..CalibrationReport::default()
        };
        let text = latex(&report);
        assert!(!text.contains(r"\input{"), "{text}");
        assert_eq!(text.matches(r"\end{table}").count(), 1);
        assert_eq!(text.lines().filter(|l| l.starts_with('%')).count(), 1);
    }
}
