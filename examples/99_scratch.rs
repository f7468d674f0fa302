use couloir::io;
use couloir::model::{Assembled, Model, Point, Posterior, Weights};
use couloir::noise;
use couloir::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;
fn main() -> Result<()> {
    let path = std::env::args().nth(1).unwrap();
    for text in [
        "iid",
        "ar(1)",
        "ar(2)",
        "ou",
        "white + ou",
        "matern32",
        "matern32 + white",
        "ar(1) + white",
        "matern32 + white + tails",
        "matern32 + ou + white",
    ] {
        let file = io::load(Path::new(&path), &Laws::default())?;
        let n = file.event.recordings().next().unwrap().times().len();
        let m = Assembled::new(
            file.event,
            file.friction,
            noise::parse(text)?,
            &BTreeMap::new(),
        )?;
        let m: &dyn Model = &m;
        let p = Posterior::new(m)?;
        let d = p.dimension();
        let natural: Vec<f64> = p
            .parameters()
            .iter()
            .map(|q| match q.name.as_str() {
                "mu" => 0.45,
                "xi" => 600.0,
                "phi" => 0.7,
                "phi[1]" => 0.7,
                "phi[2]" => 0.2,
                "nu" => 5.0,
                "time_matern" => 0.5,
                "time_ou" => 1.0,
                "sd_matern" | "sd_ou" => 1.0,
                _ => 0.1,
            })
            .collect();
        let z = p.line(&natural)?;
        let best = |f: &mut dyn FnMut()| {
            let mut best = f64::MAX;
            for _ in 0..15 {
                let t = Instant::now();
                for _ in 0..1000 {
                    f();
                }
                best = best.min(t.elapsed().as_secs_f64() / 1000.0 * 1e6);
            }
            best
        };
        let mut x = 0.0;
        let dens = best(&mut || {
            x += m.evaluate(Point::Line(&z), None).unwrap().natural()
        });
        let mut g = vec![0.0; d];
        let grad = best(&mut || {
            m.gradient(&z, Weights::LINE, &mut g).unwrap();
        });
        println!(
            "{n} {text:28} {dens:8.2} us, gradient {grad:8.2} us  {}",
            x.is_finite()
        );
    }
    Ok(())
}
