//! Parameters that count up, as one variable with a dimension: `phi[1]` and
//! `phi[2]` are `phi`, and a law's `mu` of each event is `mu` along `event`.

use super::data::{Values, Variable};
use crate::error::Result;

/// A parameter's place in a variable.
#[derive(Debug, Clone, PartialEq)]
struct Place {
    /// The variable's name.
    name: String,
    /// The name of the further dimension, and what this place along it is
    /// called.
    along: Option<(String, String)>,
}

/// The place that a parameter's name says.
fn place(name: &str, events: &[String]) -> Place {
    let event = events.iter().find_map(|event| {
        let own = name.strip_prefix(event.as_str())?.strip_prefix('.')?;
        Some((own, event))
    });
    if let Some((own, event)) = event {
        let along = Some(("event".to_owned(), event.clone()));
        return Place { name: own.to_owned(), along };
    }
    let parts = name.split_once('[').and_then(|(head, rest)| {
        let (label, tail) = rest.split_once(']')?;
        (!tail.contains('[')).then(|| (format!("{head}{tail}"), label))
    });
    match parts {
        Some((name, label)) => {
            let dimension = format!("{name}_dim_0");
            Place { name, along: Some((dimension, label.to_owned())) }
        }
        None => Place { name: name.to_owned(), along: None },
    }
}

/// Parameters that make one variable.
struct Together {
    name: String,
    dimension: Option<String>,
    labels: Vec<String>,
    columns: Vec<usize>,
}

/// Which parameters go together, in the order of the first of each. One whose
/// place is taken, or that does not fill the dimension `event`, stays by
/// itself under its own name.
fn sorted(names: &[String], events: &[String]) -> Vec<Together> {
    let mut all: Vec<Together> = Vec::new();
    for (column, name) in names.iter().enumerate() {
        let Place { name, along } = place(name, events);
        let (dimension, label) = along.unzip();
        let same = |one: &&mut Together| {
            one.name == name
                && one.dimension == dimension
                && label.as_ref().is_some_and(|l| !one.labels.contains(l))
        };
        match all.iter_mut().find(same) {
            Some(one) => {
                one.labels.extend(label);
                one.columns.push(column);
            }
            None => {
                let labels = label.into_iter().collect();
                let columns = vec![column];
                all.push(Together { name, dimension, labels, columns });
            }
        }
    }
    let whole = |one: &Together| match one.dimension.as_deref() {
        Some("event") => one.labels == events,
        _ => true,
    };
    let clash = |one: &Together| {
        let same = |other: &&Together| other.name == one.name;
        all.iter().filter(same).count() > 1
    };
    let apart: Vec<bool> =
        all.iter().map(|one| clash(one) || !whole(one)).collect();
    all.into_iter()
        .zip(apart)
        .flat_map(
            |(one, apart)| if apart { alone(&one, names) } else { vec![one] },
        )
        .collect()
}

/// Each parameter by itself, under its own name.
fn alone(one: &Together, names: &[String]) -> Vec<Together> {
    let by_itself = |column: &usize| Together {
        name: names[*column].clone(),
        dimension: None,
        labels: Vec::new(),
        columns: vec![*column],
    };
    one.columns.iter().map(by_itself).collect()
}

/// Parameters as they are named, with their units, and the labels of the
/// events that they may be of.
pub(super) struct Named<'a> {
    pub(super) names: &'a [String],
    pub(super) units: &'a [String],
    pub(super) events: &'a [String],
}

/// Draws of parameters as variables with the dimensions chain, draw and, where
/// several go together, one more, with its coordinate. `rows` has a value per
/// parameter for each draw.
pub(super) fn variables(
    of: &Named<'_>,
    [chains, draws]: [usize; 2],
    rows: &[&[f64]],
) -> Result<Vec<Variable>> {
    let mut made = Vec::new();
    for one in sorted(of.names, of.events) {
        let Together { name, dimension, labels, columns } = one;
        let values =
            rows.iter().flat_map(|row| columns.iter().map(|i| row[*i]));
        let values = Values::Real(values.collect());
        let unit = &of.units[columns[0]];
        let mut shape = vec![("chain", chains), ("draw", draws)];
        if let Some(dimension) = &dimension {
            shape.push((dimension, columns.len()));
        }
        made.push(Variable::new(name, unit, &shape, values)?);
        if let Some(dimension) = &dimension {
            let shape = [(dimension.as_str(), labels.len())];
            let values = label_values(labels);
            made.push(Variable::new(dimension, "", &shape, values)?);
        }
    }
    Ok(made)
}

/// Labels that all count, as numbers.
fn label_values(labels: Vec<String>) -> Values {
    let numbers: Option<Vec<i64>> =
        labels.iter().map(|label| label.parse().ok()).collect();
    numbers.map_or(Values::Words(labels), Values::Whole)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(names: &[&str]) -> Vec<String> {
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    /// The variables of one draw, in which the i-th parameter is i.
    fn of_one_draw(parameters: &[&str], events: &[&str]) -> Vec<Variable> {
        let (parameters, events) = (names(parameters), names(events));
        let units = vec!["1".to_owned(); parameters.len()];
        let named =
            Named { names: &parameters, units: &units, events: &events };
        let row: Vec<f64> = (0..parameters.len()).map(|i| i as f64).collect();
        variables(&named, [1, 1], &[&row]).unwrap()
    }

    fn told(all: &[Variable]) -> Vec<(&str, Vec<usize>)> {
        all.iter().map(|v| (v.name.as_str(), v.shape.clone())).collect()
    }

    #[test]
    fn a_vector_is_one_variable_with_its_coordinate() {
        let all = of_one_draw(&["mu", "phi[1]", "sigma2", "phi[2]"], &[]);
        let expected = [
            ("mu", vec![1, 1]),
            ("phi", vec![1, 1, 2]),
            ("phi_dim_0", vec![2]),
            ("sigma2", vec![1, 1]),
        ];
        assert_eq!(told(&all), expected);
        assert_eq!(all[1].values.reals(), [1.0, 3.0]);
        assert_eq!(all[2].values, Values::Whole(vec![1, 2]));
        assert!(all[2].is_coordinate() && !all[1].is_coordinate());
    }

    #[test]
    fn a_vector_of_vectors_has_pairs_for_labels() {
        let all = of_one_draw(&["phi[1,1]", "phi[2,1]"], &[]);
        assert_eq!(all[1].values, Values::Words(names(&["1,1", "2,1"])));
    }

    #[test]
    fn events_are_a_dimension_where_each_has_the_parameter() {
        let parameters = ["A.mu", "A.xi", "B.mu", "sigma2"];
        let all = of_one_draw(&parameters, &["A", "B"]);
        let expected = [
            ("mu", vec![1, 1, 2]),
            ("event", vec![2]),
            ("A.xi", vec![1, 1]),
            ("sigma2", vec![1, 1]),
        ];
        assert_eq!(told(&all), expected);
    }

    #[test]
    fn names_that_would_be_the_same_stay_as_they_are() {
        let all = of_one_draw(&["phi", "phi[1]", "a[1].b", "x[1][2]"], &[]);
        let found: Vec<_> = told(&all).into_iter().map(|t| t.0).collect();
        assert_eq!(found, ["phi", "phi[1]", "a.b", "a.b_dim_0", "x[1][2]"]);
    }
}
