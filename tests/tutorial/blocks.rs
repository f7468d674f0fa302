//! The commands of a page, each with what the page shows of its output.

/// A command, and what is shown of what it prints.
pub(crate) struct Step {
    pub(crate) command: String,
    pub(crate) shown: Option<String>,
}

/// Commands as a page writes them. `cargo run --release --` stands for
/// `couloir`.
pub(crate) fn steps(page: &str) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    // Whether the next block is what the last command prints.
    let mut is_new = false;
    for part in parts(page) {
        let commands = part.replace("cargo run --release --", "couloir");
        let is_commands = !part.is_empty()
            && commands.lines().all(|line| line.starts_with("couloir "));
        if is_commands {
            let of = |line: &str| Step { command: line.into(), shown: None };
            steps.extend(commands.lines().map(of));
        } else if is_new && let Some(last) = steps.last_mut() {
            last.shown = (!part.is_empty()).then_some(part);
        }
        is_new = is_commands;
    }
    steps
}

/// The blocks of plain text. A heading counts as an empty one, so that no
/// command owns a block of another section; so does a block of code.
fn parts(page: &str) -> Vec<String> {
    let mut parts = Vec::new();
    let mut block: Option<(bool, String)> = None;
    for line in page.lines() {
        let fence = line.strip_prefix("```");
        match (&mut block, fence) {
            (None, Some(kind)) => {
                block = Some((kind == "text", String::new()));
            }
            (Some(_), Some(_)) => {
                let (is_text, text) = block.take().unwrap_or_default();
                parts.push(if is_text { text } else { String::new() });
            }
            (Some((_, text)), None) => {
                text.push_str(line);
                text.push('\n');
            }
            (None, None) if line.starts_with('#') => parts.push(String::new()),
            (None, None) => {}
        }
    }
    parts
}

/// A command's words, as a shell takes them: quotes hold some together.
pub(crate) fn words(command: &str) -> Vec<String> {
    let mut words = Vec::new();
    for (i, part) in command.split('"').enumerate() {
        match i % 2 {
            0 => words.extend(part.split_whitespace().map(str::to_owned)),
            _ => words.push(part.to_owned()),
        }
    }
    words
}

#[test]
fn commands_and_their_output_are_told_apart() {
    let page = "```text\ncouloir a \"b c\"\n```\nso\n```text\nd\n```\n\
                ```text\ncargo run --release -- e\n```\n# New\n```text\nf\n```";
    let found = steps(page);
    let [one, other] = &found[..] else { panic!("{}", found.len()) };
    assert_eq!(words(&one.command), ["couloir", "a", "b c"]);
    assert_eq!(one.shown.as_deref(), Some("d\n"));
    assert_eq!(other.command, "couloir e");
    assert_eq!(other.shown, None);
}
