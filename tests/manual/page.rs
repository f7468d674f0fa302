//! One page of the reference.

use super::drawn;

/// A page of the reference.
pub(crate) struct Page {
    /// Where it stands below `manual/src`.
    pub(crate) path: String,
    /// What it is of, as an event file calls that.
    pub(crate) name: String,
    /// The same in words.
    pub(crate) head: String,
    /// All of it.
    pub(crate) text: String,
}

impl Page {
    /// The page of a part in a room, its file called `file` and itself `name`.
    pub(crate) fn of(
        room: &str,
        [file, name]: [&str; 2],
        head: &str,
        text: &str,
    ) -> Self {
        let first = head.split("\n\n").next().unwrap_or(head);
        let picture = format!("pictures/{room}-{file}.svg");
        let drawn = drawn::has(room);
        let picture = match drawn {
            true => format!(
                "\n![{name}: {}](../../{picture})\n",
                drawn::caption(room)
            ),
            false => String::new(),
        };
        Self {
            path: format!("reference/{room}/{file}.md"),
            name: name.to_owned(),
            head: first.replace('\n', " "),
            text: format!("{GENERATED}# {name}\n\n{text}{picture}"),
        }
    }
}

/// What a page says of where it is from.
pub(crate) const GENERATED: &str =
    "<!-- Written by tests/manual from the code: change it there. -->\n\n";

/// `VelocityWeakening` of `velocity-weakening`.
pub(crate) fn struct_name(name: &str) -> String {
    let capital = |word: &str| {
        let (first, rest) = word.split_at(1);
        first.to_uppercase() + rest
    };
    name.split('-').map(capital).collect()
}

/// `half-normal` of `HalfNormal`.
pub(crate) fn file_name(name: &str) -> String {
    let mut file = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !file.is_empty() {
            file.push('-');
        }
        file.extend(letter.to_lowercase());
    }
    file
}
