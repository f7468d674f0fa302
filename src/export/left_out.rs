//! Leave-one-out prediction as JSON.

use serde_json::{Value, json};

use super::data::LeftOut;
use crate::draws::k_threshold;

impl LeftOut {
    /// As `calibration.json` has it under `loo`: `elpd`, `se`, `p_loo`, how
    /// many `draws` it is of, what each is worth (`r_eff`), and of each datum
    /// its part of elpd (`pointwise`) and its Pareto shape (`pareto_k`), to be
    /// trusted below `pareto_k_threshold`. Numbers that are not finite are
    /// null.
    ///
    /// ```
    /// use couloir::draws::loo;
    /// use couloir::export::LeftOut;
    /// let found = loo(&vec![vec![-1.5, -0.5]; 100]).ok_or("no table")?;
    /// let json = LeftOut::new(found, 100, 1.0).json();
    /// assert_eq!(json["draws"], 100);
    /// assert_eq!(json["pointwise"].as_array().map(Vec::len), Some(2));
    /// # Ok::<(), &str>(())
    /// ```
    pub fn json(&self) -> Value {
        let Self { loo, draws, efficiency } = self;
        json!({
            "elpd": loo.elpd,
            "se": loo.se,
            "p_loo": loo.p_loo,
            "draws": draws,
            "r_eff": efficiency,
            "pointwise": loo.pointwise,
            "pareto_k": loo.pareto_k,
            "pareto_k_threshold": k_threshold(*draws),
        })
    }
}
