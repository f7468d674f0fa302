use couloir::Seed;
use couloir::discrepancy::{attribute, mechanisms::catalogue};
use couloir::infer::Quiet;
use couloir::model::Assembled;
use couloir::physics::friction::Laws;
fn main() -> couloir::Result<()> {
    let path = std::env::args().nth(1).unwrap();
    let seed: u64 = std::env::args().nth(2).map_or(1, |s| s.parse().unwrap());
    let file =
        couloir::io::load(std::path::Path::new(&path), &Laws::default())?;
    let model =
        Assembled::new(file.event, file.friction, file.noise, &file.priors)?;
    let extent = model.event().extent();
    println!("{extent:?}");
    let names = vec![model.noise().split('(').next().unwrap().to_owned()]
        .into_iter()
        .chain(model.friction().split(" + ").map(str::to_owned))
        .collect::<Vec<_>>();
    let all = catalogue(&extent, &names);
    let t = std::time::Instant::now();
    let found = attribute(&model, &all, Seed::new(seed), &Quiet)?;
    println!(
        "none {:.3} +- {:.3} {:?}",
        found.none.log_evidence, found.none.se, found.none.warnings
    );
    for (m, f) in all.iter().zip(&found.candidates) {
        let s: Vec<_> = couloir::draws::summarise(&f.draws)
            .iter()
            .take(f.added)
            .map(|s| {
                format!("{} {:.3} [{:.3} {:.3}]", s.name, s.mean, s.q05, s.q95)
            })
            .collect();
        println!(
            "{:20} {:?} {:?} {:.3} +- {:.3} bf10 {:.2} {:?} {:?}",
            m.name(),
            m.coordinate(),
            m.form(),
            f.log_evidence,
            f.se,
            (f.log_evidence - found.none.log_evidence)
                / std::f64::consts::LN_10,
            s,
            f.warnings
        );
    }
    println!("{:?}", t.elapsed());
    for axis in [
        couloir::physics::forces::Axis::Place,
        couloir::physics::forces::Axis::Time,
        couloir::physics::forces::Axis::Speed,
    ] {
        let t = std::time::Instant::now();
        let f = couloir::discrepancy::locate(
            &model,
            &extent,
            axis,
            found.none.own(),
            Seed::new(9),
        )?;
        println!(
            "{axis:?} lnB {:.2} {:?} runs {:?} width {:.2}",
            f.log_bayes_factor,
            t.elapsed(),
            f.runs(),
            f.width
        );
        println!(
            "{}",
            f.mean
                .iter()
                .map(|x| format!("{x:.2}"))
                .collect::<Vec<_>>()
                .join(" ")
        );
    }
    Ok(())
}
