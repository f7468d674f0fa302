//! What a parameter is called by, and its unit.

/// The name and unit of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Label<'a> {
    name: &'a str,
    unit: &'a str,
    indices: [Option<usize>; 3],
    /// The label of the event that it is a parameter of; empty for none.
    event: &'a str,
}

impl<'a> Label<'a> {
    /// A parameter of this name; unit "1" for a pure number.
    pub const fn new(name: &'a str, unit: &'a str) -> Self {
        Self { name, unit, indices: [None; 3], event: "" }
    }

    /// The `index`-th of several (from 0); its name counts from 1. A second
    /// index is that of a list within one of several, a third of one in
    /// that.
    ///
    /// ```
    /// use couloir::Label;
    /// let phi = Label::new("phi", "1");
    /// assert_eq!(phi.at(2).name(), "phi[3]");
    /// assert_eq!(phi.at(2).at(0).name(), "phi[3,1]");
    /// ```
    #[must_use]
    pub const fn at(self, index: usize) -> Self {
        let indices = match self.indices {
            [None, ..] => [Some(index), None, None],
            [outer, None, _] => [outer, Some(index), None],
            [outer, inner, _] => [outer, inner, Some(index)],
        };
        Self { indices, ..self }
    }

    /// The same within an event of this label, where there is one.
    pub(super) const fn of_event(self, event: &'a str) -> Self {
        Self { event, ..self }
    }

    /// Its name, with its indices in brackets where it has any, and the label
    /// of its event before it.
    pub fn name(&self) -> String {
        let name = self.own_name();
        match self.event {
            "" => name,
            event => format!("{event}.{name}"),
        }
    }

    fn own_name(&self) -> String {
        let indices = self.indices.iter().flatten();
        let indices: Vec<_> = indices.map(|i| (i + 1).to_string()).collect();
        match indices.is_empty() {
            true => self.name.to_owned(),
            false => format!("{}[{}]", self.name, indices.join(",")),
        }
    }

    /// Its unit.
    pub fn unit(&self) -> &'a str {
        self.unit
    }
}
