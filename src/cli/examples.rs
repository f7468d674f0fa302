//! What stands at the end of every help: lines to copy.

pub(super) const ALL: &str = "\
Examples:
  couloir new my-event
  couloir calibrate my-event --out results
  couloir diagnose my-event --out results";

pub(super) const CALIBRATE: &str = "\
Examples:
  couloir calibrate my-event --out results
  couloir calibrate my-event --friction coulomb --noise \"ar(1)\"
  couloir calibrate my-event --noise infer --rest
  couloir calibrate my-event --quick";

pub(super) const COMPARE: &str = "\
Examples:
  couloir compare my-event --model \"coulomb, ar(1)\" --model \"voellmy, ar(1)\"";

pub(super) const DIAGNOSE: &str = "\
Examples:
  couloir diagnose my-event --out results
  couloir diagnose my-event --quick
  couloir diagnose sensor-1 sensor-2 --one-law --out results";

pub(super) const SWEEP: &str = "\
Examples:
  couloir sweep survey --out results
  couloir sweep \"survey/2026-*\" --out results -- --quick
  couloir sweep list.csv --verb calibrate --out results -- --noise=infer
  couloir sweep survey --out results --retry";

pub(super) const POPULATION: &str = "\
Examples:
  couloir population results --out population
  couloir population results --of mu";

pub(super) const SIMULATE: &str = "\
Examples:
  couloir simulate my-event --set mu=0.3 --set xi=1200
  couloir simulate my-event --out run";

pub(super) const NEW: &str = "\
Examples:
  couloir new my-event";

#[cfg(feature = "import")]
pub(super) const IMPORT: &str = "\
Examples:
  couloir import log.gpx --out my-event
  couloir import log.csv --columns \"time=UTC,speed=v_kmh:km/h\" \\
    --terrain dem.asc --path path.shp --crs EPSG:31254 --out my-event
  couloir import --front front.csv --terrain dem.tif --path path.shp \\
    --out my-event
  couloir import sensor-1.csv sensor-2.csv --front front.csv \\
    --terrain dem.tif --path path.shp --out my-events
  couloir import --avaframe avaMine --particle mean --out my-event";

pub(super) const BENCH: &str = "\
Examples:
  couloir bench my-event --draws 2000";

pub(super) const CHALLENGE: &str = "\
Examples:
  couloir challenge --cases 24 --out scores";

pub(super) const REPRODUCE: &str = "\
Examples:
  couloir reproduce --samples 20 --out study";

pub(super) const COMPLETIONS: &str = "\
Examples:
  couloir completions bash > ~/.local/share/bash-completion/completions/couloir";

pub(super) const MAN: &str = "\
Examples:
  couloir man --out ~/.local/share/man/man1";

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::super::Cli;

    /// The arguments of a line, those in quotes together, up to where the
    /// shell would send the answer elsewhere.
    fn arguments(line: &str) -> Vec<String> {
        let line = line.split(" > ").next().unwrap();
        let parts = line.split('"').enumerate();
        parts
            .flat_map(|(i, part)| match i % 2 {
                0 => part.split_whitespace().map(str::to_owned).collect(),
                _ => vec![part.to_owned()],
            })
            .collect()
    }

    #[test]
    fn every_example_is_a_command() {
        let all = Cli::command();
        let helps = [&all].into_iter().chain(all.get_subcommands());
        let mut tried = 0;
        for help in helps {
            let text = help.get_after_help().unwrap().to_string();
            let text = text.replace("\\\n", " ");
            for line in text.lines().skip(1) {
                let found = all.clone().try_get_matches_from(arguments(line));
                assert!(found.is_ok(), "{line}: {}", found.unwrap_err());
                tried += 1;
            }
        }
        assert!(tried > 12, "{tried}");
    }
}
