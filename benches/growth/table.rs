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
    building: f64,
    density: f64,
    gradient: f64,
}

impl Row {
    /// Of a model that took so many seconds to build.
    pub(crate) fn new(
        size: usize,
        model: Box<dyn Model>,
        building: f64,
    ) -> Result<Self> {
        let posterior = Posterior::new(model.as_ref())?;
        let names = posterior.parameters().iter().map(|p| p.name.as_str());
        let z = posterior.line(&names.map(typical).collect::<Vec<_>>())?;
        let longest = f64::INFINITY;
        Ok(Self {
            size,
            model,
            z,
            building,
            density: longest,
            gradient: longest,
        })
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

/// A value that lets the mass run as far as recorded avalanches do.
fn typical(name: &str) -> f64 {
    let own = name.rsplit('.').next().unwrap_or(name);
    match own.split('[').next() {
        Some("mu") => 0.25,
        Some("xi") => 800.0,
        Some("sigma2") => 9.0,
        Some("spread") => 1.0,
        _ => 0.1,
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

/// Measures all sizes in turn, and prints the shortest times; below them the
/// exponents of growth, of all sizes and of the upper half.
pub(crate) fn print(what: &str, mut rows: Vec<Row>) {
    for _ in 0..ROUNDS {
        rows.iter_mut().for_each(Row::measure);
    }
    println!(
        "\n| {what} | building it | density | gradient | gradient/density |"
    );
    println!("| ---: | ---: | ---: | ---: | ---: |");
    for row in &rows {
        let [building, density, gradient] =
            [row.building, row.density, row.gradient].map(micro);
        let ratio = row.gradient / row.density;
        let size = row.size;
        println!(
            "| {size} | {building} | {density} | {gradient} | {ratio:.2} |"
        );
    }
    let of = |time: fn(&Row) -> f64| {
        let upper = &rows[rows.len() / 2..];
        format!("{:.2}, {:.2}", exponent(&rows, time), exponent(upper, time))
    };
    let (density, gradient) = (of(|r| r.density), of(|r| r.gradient));
    let building = of(|r| r.building);
    println!("| exponents | {building} | {density} | {gradient} | |");
}

/// Seconds as microseconds, to three digits.
fn micro(seconds: f64) -> String {
    let digits = 2 - (1e6 * seconds).log10().floor().clamp(0.0, 2.0) as usize;
    format!("{:.digits$} us", 1e6 * seconds)
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
