//! The times of a model as its size grows, and the exponents of growth.

use std::hint::black_box;
use std::time::Instant;

use couloir::Result;
use couloir::model::{Model, Point, Posterior, Weights};

/// A model of some size, and the shortest times [s] seen.
pub(crate) struct Row {
    size: usize,
    model: Box<dyn Model>,
    z: Vec<f64>,
    density: f64,
    gradient: f64,
}

impl Row {
    pub(crate) fn new(size: usize, model: Box<dyn Model>) -> Result<Self> {
        let count = Posterior::new(model.as_ref())?.dimension();
        let z = (0..count).map(|i| 0.1 * (i as f64).sin()).collect();
        let longest = f64::INFINITY;
        Ok(Self { size, model, z, density: longest, gradient: longest })
    }

    fn measure(&mut self) {
        let (model, z) = (self.model.as_ref(), &self.z);
        let mut gradient = vec![0.0; z.len()];
        self.density = self.density.min(shortest(|| {
            black_box(model.evaluate(Point::Line(black_box(z)), None)).is_ok()
        }));
        self.gradient = self.gradient.min(shortest(|| {
            let weights = Weights::LINE;
            black_box(model.gradient(black_box(z), weights, &mut gradient))
                .is_ok()
        }));
    }
}

/// The mean seconds of as many calls as fill about a millisecond.
fn shortest(mut work: impl FnMut() -> bool) -> f64 {
    let begun = Instant::now();
    let mut count = 0;
    while begun.elapsed().as_secs_f64() < 1e-3 {
        assert!(work(), "a model failed");
        count += 1;
    }
    begun.elapsed().as_secs_f64() / f64::from(count)
}

/// How often each size is measured, in turn with the others.
const ROUNDS: usize = 60;

/// Measures all sizes in turn, and prints the shortest times.
pub(crate) fn print(what: &str, mut rows: Vec<Row>) {
    for _ in 0..ROUNDS {
        rows.iter_mut().for_each(Row::measure);
    }
    println!("\n| {what} | density [us] | gradient [us] | ratio |");
    println!("| ---: | ---: | ---: | ---: |");
    for row in &rows {
        println!(
            "| {} | {:.2} | {:.2} | {:.2} |",
            row.size,
            1e6 * row.density,
            1e6 * row.gradient,
            row.gradient / row.density
        );
    }
    let of = |time: fn(&Row) -> f64| {
        let upper = &rows[rows.len() / 2 - 1..];
        (exponent(&rows, time), exponent(upper, time))
    };
    let (density, gradient) = (of(|r| r.density), of(|r| r.gradient));
    println!(
        "\nExponents, of all sizes and of the upper half: density {:.2} and \
         {:.2}, gradient {:.2} and {:.2}.",
        density.0, density.1, gradient.0, gradient.1
    );
}

/// The slope of ln time by ln size, by least squares.
fn exponent(rows: &[Row], time: fn(&Row) -> f64) -> f64 {
    let points: Vec<(f64, f64)> =
        rows.iter().map(|r| ((r.size as f64).ln(), time(r).ln())).collect();
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |s, p| (s.0 + p.0, s.1 + p.1));
    let (x, y) = (x / n, y / n);
    let by = |f: fn(f64, f64) -> f64| -> f64 {
        points.iter().map(|p| f(p.0 - x, p.1 - y)).sum()
    };
    by(|x, y| x * y) / by(|x, _| x * x)
}
