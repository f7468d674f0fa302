//! The motion and the forces on it, against closed forms, energy and other
//! integrators.

mod by_speed;
mod changed_motion;
mod depth;
mod energy;
mod exact_motion;
mod gradients;
mod mechanisms;
mod random_blocks;
mod reverse;
mod terrain;
mod track;
mod unknowns;
