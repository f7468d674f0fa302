//! Models that the macro accepts where it might stumble; here it is enough
//! that they compile without a warning.

mod inside_a_function;
mod names_of_its_own;
mod on_one_line;
