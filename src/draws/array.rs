//! The draws of one variable, a list or a table as the model has it.

use super::Draws;

/// The draws of a variable with its dimensions: of `beta[1]` .. `beta[5]` one
/// array of five columns.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Array {
    /// The variable's name, without indices.
    pub name: String,
    /// Chains, iterations, then the variable's own dimensions; a number by
    /// itself has none.
    pub shape: Vec<usize>,
    /// All values, the last index running fastest; NaN where the variable
    /// has no entry.
    pub values: Vec<f64>,
}

impl Draws {
    /// The names of the variables, without indices, in the order in which
    /// they come first.
    pub fn variables(&self) -> Vec<&str> {
        let mut found: Vec<&str> = Vec::new();
        for name in self.names() {
            let (base, _) = split(name);
            if !found.contains(&base) {
                found.push(base);
            }
        }
        found
    }

    /// The draws of one variable; `None` where there is none of that name.
    ///
    /// ```
    /// use couloir::draws::Draws;
    /// let names = ["mu", "x[1,1]", "x[1,2]"].map(String::from).to_vec();
    /// let mut draws = Draws::new(names, vec!["1".into(); 3])?;
    /// draws.push_chain(vec![0.0, 1.0, 2.0, 0.5, 3.0, 4.0], None)?;
    /// assert_eq!(draws.variables(), ["mu", "x"]);
    /// let x = draws.array("x").unwrap();
    /// // One chain of two iterations, each a table of 1 by 2.
    /// assert_eq!(x.shape, [1, 2, 1, 2]);
    /// assert_eq!(x.values, [1.0, 2.0, 3.0, 4.0]);
    /// # Ok::<(), couloir::Error>(())
    /// ```
    pub fn array(&self, variable: &str) -> Option<Array> {
        let columns = self.names().iter().enumerate();
        let columns: Vec<(usize, Vec<usize>)> = columns
            .filter_map(|(i, name)| {
                let (base, indices) = split(name);
                (base == variable).then_some((i, indices))
            })
            .collect();
        let depth = columns.iter().map(|(_, at)| at.len()).max()?;
        let own: Vec<usize> = (0..depth)
            .map(|d| columns.iter().filter_map(|c| c.1.get(d)).copied().max())
            .map(|largest| largest.unwrap_or(1))
            .collect();
        let size: usize = own.iter().product();
        let mut values = Vec::with_capacity(self.total() * size);
        for row in self.rows() {
            let begin = values.len();
            values.resize(begin + size, f64::NAN);
            for (column, at) in &columns {
                values[begin + place(at, &own)] = row[*column];
            }
        }
        let shape = [vec![self.chains(), self.iterations()], own].concat();
        Some(Array { name: variable.to_owned(), shape, values })
    }
}

/// Where indices that count from 1 lie in an array of these dimensions.
fn place(at: &[usize], dimensions: &[usize]) -> usize {
    let indices = at.iter().chain(std::iter::repeat(&1)).zip(dimensions);
    indices.fold(0, |place, (i, size)| place * size + i - 1)
}

/// A name without its indices, and these, from 1; what stands in brackets and
/// is no index belongs to the name.
fn split(name: &str) -> (&str, Vec<usize>) {
    let inside = name.strip_suffix(']').and_then(|n| n.rsplit_once('['));
    let Some((base, inside)) = inside else { return (name, Vec::new()) };
    let index = |text: &str| text.parse().ok().filter(|i| *i > 0);
    let indices: Option<Vec<usize>> = inside.split(',').map(index).collect();
    indices.map_or((name, Vec::new()), |indices| (base, indices))
}
