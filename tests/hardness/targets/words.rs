//! Words of event files and of the command line.

use std::ffi::OsString;
use std::path::Path;

use couloir::infer::Quiet;
use couloir::physics::friction::Laws;
use couloir::prior::{AnyPrior, Distribution};
use couloir::scalar::{Plain, Real};
use couloir::sweep::Shard;
use couloir::{Error, Seed, noise};

/// An input as the text of an argument, which a shell hands over whole.
pub(crate) fn text(input: &[u8]) -> Result<&str, Error> {
    std::str::from_utf8(input).map_err(|_| Error::input("is no text"))
}

/// A prior that is taken says itself in words that mean the same, and has
/// draws at which it has a density.
pub(crate) fn prior(_: &Path, input: &[u8]) -> Result<(), Error> {
    let prior = AnyPrior::parse(text(input)?)?;
    let again = AnyPrior::parse(&prior.to_string())?;
    assert_eq!(prior, again);
    let mut rng = Seed::new(3).rng();
    let at = [-1.0, 0.0, 0.5, 1.0, 1e9, f64::MIN_POSITIVE];
    let draws = (0..2).filter_map(|_| prior.draw(&mut rng));
    for x in at.into_iter().chain(draws) {
        let density = prior.log_density(Real::<Plain>::new(x)).value();
        assert!(!density.is_nan(), "{prior} at {x}: {density}");
    }
    for p in [0.0, 1e-9, 0.5, 1.0] {
        let quantile = prior.quantile(p);
        assert!(!quantile.is_some_and(f64::is_nan), "{prior} at {p}");
    }
    Ok(())
}

pub(crate) fn friction(_: &Path, input: &[u8]) -> Result<(), Error> {
    let law = Laws::default().parse(text(input)?)?;
    let again = Laws::default().parse(&law.to_string())?;
    assert_eq!(law.to_string(), again.to_string());
    Ok(())
}

pub(crate) fn noise(_: &Path, input: &[u8]) -> Result<(), Error> {
    let noise = noise::parse(text(input)?)?;
    let again = noise::parse(&noise.name())?;
    assert_eq!(noise.dimension(), again.dimension());
    Ok(())
}

pub(crate) fn shard(_: &Path, input: &[u8]) -> Result<(), Error> {
    let shard: Shard = text(input)?.parse()?;
    assert_eq!(shard.to_string().parse::<Shard>()?, shard);
    Ok(())
}

/// `--set` of `simulate`.
pub(crate) fn set(_: &Path, input: &[u8]) -> Result<(), Error> {
    let option = format!("--set={}", text(input)?);
    let words = ["simulate".into(), OsString::from(option)];
    couloir::cli::made(&Laws::default(), &words, &Quiet).map(drop)
}
