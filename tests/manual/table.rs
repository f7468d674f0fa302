//! Tables of parameters, in Markdown.

use couloir::prior::AnyPrior;

/// A parameter as a page has it.
pub(crate) struct Row {
    pub(crate) name: String,
    pub(crate) meaning: String,
    pub(crate) unit: String,
    pub(crate) prior: String,
}

/// The table; the column of meanings is left out where no row has one.
pub(crate) fn parameters(rows: &[Row]) -> String {
    let all = rows.iter().all(|row| row.meaning.is_empty());
    let (head, rule) = if all { ("", "") } else { (" meaning |", "---|") };
    let mut table = format!(
        "| parameter |{head} unit | default prior | range | its middle 90 % |\n\
         |---|{rule}---|---|---|---|\n"
    );
    for row in rows {
        let meaning = match all {
            true => String::new(),
            false => format!(" {} |", row.meaning.replace('\n', " ")),
        };
        let [range, middle] = spans(&row.prior);
        table.push_str(&format!(
            "| `{}` |{meaning} {} | `{}` | {range} | {middle} |\n",
            row.name,
            row.unit,
            rounded(&row.prior)
        ));
    }
    table
}

/// A prior with arguments of three digits where they have many.
fn rounded(prior: &str) -> String {
    let Ok(known) = AnyPrior::parse(prior) else { return prior.to_owned() };
    let argument = |x: f64| match x.to_string() {
        few if few.len() <= 7 => few,
        _ => short(x),
    };
    let all: Vec<String> =
        known.arguments().into_iter().map(argument).collect();
    format!("{}({})", known.name(), all.join(", "))
}

/// Where a prior's density is positive, and where nine tenths of it lie; "of
/// the event" where it waits for the scales of one.
fn spans(prior: &str) -> [String; 2] {
    let Ok(prior) = AnyPrior::parse(prior) else {
        return ["set by the event", "set by the event"].map(str::to_owned);
    };
    let at = |p: f64| prior.quantile(p).map_or("n/a".to_owned(), short);
    let [low, high] = [at(0.0), at(1.0)];
    let range = match (low.as_str(), high.as_str()) {
        ("-inf", "inf") => "any".to_owned(),
        (low, "inf") => format!("above {low}"),
        (low, high) => format!("{low} to {high}"),
    };
    [range, format!("{} to {}", at(0.05), at(0.95))]
}

/// A number with three significant digits.
pub(crate) fn short(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    let digits = 2 - x.abs().log10().floor() as i32;
    let scale = 10f64.powi(digits);
    let rounded = (x * scale).round() / scale;
    format!("{rounded:.*}", digits.max(0) as usize)
}
