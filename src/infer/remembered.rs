//! A model whose densities are kept, so that the same run goes on where it
//! was stopped.

use std::hash::{Hash, Hasher};

use nalgebra::DMatrix;

use crate::checkpoint::{Checkpoint, Name};
use crate::error::Result;
use crate::model::{Density, Information, Listener, Model, Point, Weights};
use crate::scalar::Plain;

/// A model of which a checkpoint keeps the densities and gradients. Whatever a
/// backend does with them, it does again in a run begun again, at no cost of
/// motions.
///
/// A point that the model rejects is not kept, nor what a listener hears.
pub(crate) struct Remembered<'m> {
    model: &'m dyn Model,
    checkpoint: &'m Checkpoint,
    /// Tells it from other models of the same run.
    name: Name,
}

/// What was asked for at a point.
#[derive(Clone, Copy, Hash)]
enum Asked<'z> {
    Line(Bits<'z>),
    Natural(Bits<'z>),
    Gradient(Bits<'z>, [u64; 3]),
}

/// Numbers that are the same where every bit is.
#[derive(Clone, Copy)]
struct Bits<'z>(&'z [f64]);

impl Hash for Bits<'_> {
    fn hash<H: Hasher>(&self, hasher: &mut H) {
        for value in self.0 {
            hasher.write_u64(value.to_bits());
        }
    }
}

impl<'m> Remembered<'m> {
    /// A model under a name that no other of the run has.
    pub(crate) fn new(
        model: &'m dyn Model,
        checkpoint: &'m Checkpoint,
        name: &str,
    ) -> Self {
        Self { model, checkpoint, name: Name::of(name) }
    }

    /// What is kept of a density, with the gradient behind it; made and kept
    /// where nothing is.
    fn density(
        &self,
        asked: Asked<'_>,
        gradient: &mut [f64],
        make: impl FnOnce(&mut [f64]) -> Result<Density>,
    ) -> Result<Density> {
        let name = Name::of((self.name, asked));
        let kept = self.checkpoint.get(name);
        if let Some(density) = kept.and_then(|b| read(b, gradient)) {
            return Ok(density);
        }
        let density = make(gradient)?;
        if density.rejected.is_none() {
            self.checkpoint
                .put(name, |bytes| write(bytes, &density, gradient));
        }
        Ok(density)
    }
}

impl Model for Remembered<'_> {
    fn evaluate(
        &self,
        point: Point<'_>,
        listener: Option<&mut dyn Listener<Plain>>,
    ) -> Result<Density> {
        let (asked, again) = match (&point, &listener) {
            (Point::Line(z), None) => (Asked::Line(Bits(z)), Point::Line(z)),
            (Point::Natural(x), None) => {
                (Asked::Natural(Bits(x)), Point::Natural(x))
            }
            _ => return self.model.evaluate(point, listener),
        };
        self.density(asked, &mut [], |_| self.model.evaluate(again, None))
    }

    fn gradient(
        &self,
        z: &[f64],
        weights: Weights,
        gradient: &mut [f64],
    ) -> Result<Density> {
        let Weights { prior, jacobian, likelihood } = weights;
        let weighted = [prior, jacobian, likelihood].map(f64::to_bits);
        let asked = Asked::Gradient(Bits(z), weighted);
        let make =
            |gradient: &mut [f64]| self.model.gradient(z, weights, gradient);
        self.density(asked, gradient, make)
    }

    /// Not kept: it is long.
    fn information(&self, z: &[f64]) -> Result<Information> {
        self.model.information(z)
    }

    fn information_along(
        &self,
        z: &[f64],
        directions: &DMatrix<f64>,
    ) -> Result<Information> {
        self.model.information_along(z, directions)
    }
}

fn write(bytes: &mut Vec<u8>, density: &Density, gradient: &[f64]) {
    bytes.extend_from_slice(&density.slides.to_le_bytes());
    let Density { log_prior, log_jacobian, log_likelihood, .. } = density;
    let parts = [log_prior, log_jacobian, log_likelihood].into_iter();
    for value in parts.chain(gradient) {
        bytes.extend_from_slice(&value.to_le_bytes());
    }
}

/// Reads what [`write`] wrote, the gradient into its place.
fn read(bytes: &[u8], gradient: &mut [f64]) -> Option<Density> {
    let (words, []) = bytes.as_chunks() else { return None };
    let (first, values) = words.split_first()?;
    let (parts, rest) = values.split_first_chunk()?;
    if rest.len() != gradient.len() {
        return None;
    }
    for (slope, value) in gradient.iter_mut().zip(rest) {
        *slope = f64::from_le_bytes(*value);
    }
    let [log_prior, log_jacobian, log_likelihood] =
        parts.map(f64::from_le_bytes);
    let slides = u64::from_le_bytes(*first);
    Some(Density {
        log_prior,
        log_jacobian,
        log_likelihood,
        slides,
        rejected: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_density_comes_back_with_its_gradient() {
        let density = Density {
            log_prior: -0.1,
            log_jacobian: 1e-300,
            log_likelihood: -1e6 / 3.0,
            slides: 3,
            rejected: None,
        };
        let (mut bytes, mut found) = (Vec::new(), [0.0; 2]);
        write(&mut bytes, &density, &[0.25, -7.0]);
        assert_eq!(read(&bytes, &mut found), Some(density));
        assert_eq!(found, [0.25, -7.0]);
        assert_eq!(read(&bytes, &mut [0.0; 3]), None);
        assert_eq!(read(&bytes[..16], &mut []), None);
    }
}
