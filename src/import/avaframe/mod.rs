//! A project of AvaFrame (<https://avaframe.org>): its terrain, its path, and
//! the particles that com1DFA wrote as tables.

mod particles;
mod project;

pub(super) use particles::logs;
pub(super) use project::Project;
