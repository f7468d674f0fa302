//! Reverse mode: numbers that leave a record of how they were formed.
//!
//! A number that carries derivatives along n directions costs as much as n
//! numbers. Here it carries one slope, by a node of a tape, and a tape has a
//! node for each number that was formed from two others. From the end
//! backwards, the adjoint of a node goes to its parents, each times its
//! slope; what arrives at the variables is the gradient, in one pass for any
//! number of them (Griewank and Walther 2008, chapter 3). Functions of one
//! number only change its slope: they need no node.
//!
//! Each thread has one tape, whose memory stays from one recording to the
//! next.

use std::cell::{Cell, RefCell};
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use super::Real;
use super::kind::Kind;

/// No recording takes place.
const NOTHING: u32 = 0;
/// The recording of a number that none can follow.
const LOST: u32 = u32::MAX;
/// What takes place of a recording that has become too long: no number is of
/// it.
const TOO_LONG: u32 = u32::MAX - 1;

/// Nodes that a tape may have, 2 GB with their adjoints; what needs more goes
/// forward, in constant memory.
const MOST_NODES: usize = 1 << 26;

/// The kind of numbers whose derivatives are found backwards along a tape.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reverse;

/// A value with its slope by a node, the store of [`Reverse`].
#[derive(Clone, Copy, Debug)]
pub struct Traced {
    value: f64,
    /// The derivative by the node.
    slope: f64,
    /// The recording, above 32 bits for the node of its tape; 0 where the
    /// number depends on no variable. One word, since a number is copied in
    /// words and would wait for two halves of one.
    place: u64,
}

/// What two numbers were made into: their nodes, and its slopes by these.
#[derive(Clone, Copy, Debug)]
struct Node {
    parents: [u32; 2],
    slopes: [f64; 2],
}

/// How many nodes are written before they are filed.
const SHEET: usize = 512;

/// What a thread is writing on: reached in one step, since nothing of it has
/// to be freed.
struct Sheet {
    /// The recording that takes place.
    recording: Cell<u32>,
    /// How many nodes there are on the tape and here.
    count: Cell<usize>,
    nodes: [Cell<Node>; SHEET],
}

/// The tape of a thread; a recording within another one is on top of it.
struct Tape {
    /// All nodes of full sheets.
    nodes: RefCell<Vec<Node>>,
    /// The direction and node of each variable.
    variables: RefCell<Vec<(usize, u32)>>,
    adjoints: RefCell<Vec<f64>>,
}

thread_local! {
    static WRITTEN: Sheet = const { Sheet {
        recording: Cell::new(NOTHING),
        count: Cell::new(0),
        nodes: [const { Cell::new(EMPTY) }; SHEET],
    } };
    static TAPE: Tape = const { Tape {
        nodes: RefCell::new(Vec::new()),
        variables: RefCell::new(Vec::new()),
        adjoints: RefCell::new(Vec::new()),
    } };
}

const EMPTY: Node = Node { parents: [0; 2], slopes: [0.0; 2] };

impl Sheet {
    /// Another node, and the number that it is.
    #[inline(always)]
    fn write(&self, value: f64, node: Node) -> Traced {
        let count = self.count.get();
        self.nodes[count % SHEET].set(node);
        self.count.set(count + 1);
        if count % SHEET == SHEET - 1 {
            self.file();
        }
        let recording = u64::from(self.recording.get());
        Traced { value, slope: 1.0, place: recording << 32 | count as u64 }
    }

    /// Puts what is written onto the tape.
    #[cold]
    #[inline(never)]
    fn file(&self) {
        TAPE.with(|tape| {
            let mut nodes = tape.nodes.borrow_mut();
            let rest = self.count.get() - nodes.len();
            nodes.extend(self.nodes[..rest].iter().map(Cell::get));
        });
        if self.count.get() > MOST_NODES {
            self.recording.set(TOO_LONG);
        }
    }

    /// Forgets all nodes but the first ones.
    fn turn_back(&self, count: usize) {
        self.count.set(count);
        TAPE.with(|tape| {
            let mut nodes = tape.nodes.borrow_mut();
            let full = count / SHEET * SHEET;
            if nodes.len() <= full {
                return;
            }
            for (slot, node) in self.nodes.iter().zip(&nodes[full..count]) {
                slot.set(*node);
            }
            nodes.truncate(full);
        });
    }
}

impl Traced {
    /// A number with derivatives that no tape knows.
    #[cold]
    fn lost(value: f64) -> Self {
        let place = u64::from(LOST) << 32;
        Self { value, slope: f64::NAN, place }
    }

    #[inline(always)]
    fn recording(&self) -> u32 {
        (self.place >> 32) as u32
    }

    #[inline(always)]
    fn node(&self) -> u32 {
        self.place as u32
    }

    /// A number made of two, with the slopes by their nodes. Numbers of
    /// another recording, as another thread may hand them over, are lost.
    /// Called: with a copy at each place the code of this kind is a sixth larger.
    #[inline(never)]
    fn join(value: f64, of: [&Self; 2], slopes: [f64; 2]) -> Self {
        WRITTEN.with(|sheet| {
            let recording = sheet.recording.get();
            if of.iter().any(|x| x.recording() != recording) {
                return Self::lost(value);
            }
            let parents = of.map(Self::node);
            sheet.write(value, Node { parents, slopes })
        })
    }
}

impl Kind for Reverse {
    type Repr = Traced;
    const DIRECTIONS: usize = 0;
    const DIFFERENTIATES: bool = true;

    #[inline(always)]
    fn constant(value: f64) -> Traced {
        Traced { value, slope: 0.0, place: 0 }
    }

    fn variable(value: f64, direction: usize) -> Traced {
        WRITTEN.with(|sheet| {
            if sheet.recording.get() == NOTHING {
                return Traced::lost(value);
            }
            // Its own parent, with slopes of 0: it passes nothing on.
            let own = sheet.count.get() as u32;
            let node = Node { parents: [own; 2], slopes: [0.0; 2] };
            TAPE.with(|t| t.variables.borrow_mut().push((direction, own)));
            sheet.write(value, node)
        })
    }

    /// No tape knows how it was formed: what needs its derivatives goes
    /// forward.
    fn assemble(value: f64, _: &[f64]) -> Traced {
        Traced::lost(value)
    }

    #[inline(always)]
    fn value(x: &Traced) -> f64 {
        x.value
    }

    #[inline(always)]
    fn partial(_: &Traced, _: usize) -> f64 {
        0.0
    }

    #[inline(always)]
    fn is_constant(x: &Traced) -> bool {
        x.place == 0 || x.slope == 0.0
    }

    #[inline(always)]
    fn chain(x: &Traced, value: f64, slope: f64) -> Traced {
        Traced { value, slope: x.slope * slope, ..*x }
    }

    #[inline(always)]
    fn chain2(
        x: &Traced,
        y: &Traced,
        value: f64,
        slope_x: f64,
        slope_y: f64,
    ) -> Traced {
        let x = Self::chain(x, value, slope_x);
        let y = Self::chain(y, value, slope_y);
        if Self::is_constant(&y) {
            x
        } else if Self::is_constant(&x) {
            y
        } else if x.place == y.place {
            Traced { slope: x.slope + y.slope, ..x }
        } else {
            Traced::join(value, [&x, &y], [x.slope, y.slope])
        }
    }

    #[inline(always)]
    fn combine<const M: usize>(
        value: f64,
        terms: [(&Traced, f64); M],
    ) -> Traced {
        let none = Self::constant(value);
        terms.into_iter().fold(none, |sum, (x, slope)| {
            Self::chain2(&sum, x, value, 1.0, slope)
        })
    }
}

/// Tells one recording from another; it holds no results.
static RECORDINGS: AtomicU32 = AtomicU32::new(1);

/// What this thread records, from now until this is dropped.
#[derive(Debug)]
pub(crate) struct Recording {
    /// The recording that goes on afterwards.
    outer: u32,
    first_node: usize,
    first_variable: usize,
}

impl Recording {
    pub(crate) fn begin() -> Self {
        let mut own = RECORDINGS.fetch_add(1, Relaxed);
        while [NOTHING, LOST, TOO_LONG].contains(&own) {
            own = RECORDINGS.fetch_add(1, Relaxed);
        }
        Self {
            outer: WRITTEN.with(|sheet| sheet.recording.replace(own)),
            first_node: WRITTEN.with(|sheet| sheet.count.get()),
            first_variable: TAPE.with(|tape| tape.variables.borrow().len()),
        }
    }

    /// The gradient of a number by the variables of this recording; whether
    /// the tape knows it.
    pub(crate) fn gradient(
        &self,
        of: &Real<Reverse>,
        gradient: &mut [f64],
    ) -> bool {
        let x = &of.0;
        gradient.fill(0.0);
        if Reverse::is_constant(x) {
            return true;
        }
        if WRITTEN.with(|sheet| x.recording() != sheet.recording.get()) {
            return false;
        }
        WRITTEN.with(Sheet::file);
        TAPE.with(|tape| {
            let adjoints = &mut *tape.adjoints.borrow_mut();
            let nodes = &mut *tape.nodes.borrow_mut();
            self.sweep(nodes, x, adjoints);
            nodes.truncate(nodes.len() / SHEET * SHEET);
            let variables = tape.variables.borrow();
            for &(direction, node) in &variables[self.first_variable..] {
                let found = adjoints.get(node as usize - self.first_node);
                if let (Some(slot), Some(found)) =
                    (gradient.get_mut(direction), found)
                {
                    *slot += found;
                }
            }
        });
        true
    }

    /// The derivatives of a number by the nodes up to its own.
    fn sweep(&self, nodes: &[Node], x: &Traced, adjoints: &mut Vec<f64>) {
        let nodes = &nodes[self.first_node..=x.node() as usize];
        adjoints.clear();
        adjoints.resize(nodes.len(), 0.0);
        adjoints[nodes.len() - 1] = x.slope;
        for (i, node) in nodes.iter().enumerate().rev() {
            let adjoint = adjoints[i];
            // Of what came to nothing no slope matters, finite or not.
            if adjoint == 0.0 {
                continue;
            }
            for (parent, slope) in node.parents.iter().zip(node.slopes) {
                let parent = *parent as usize - self.first_node;
                adjoints[parent] += adjoint * slope;
            }
        }
    }
}

impl Drop for Recording {
    fn drop(&mut self) {
        WRITTEN.with(|sheet| {
            sheet.recording.set(self.outer);
            sheet.turn_back(self.first_node);
        });
        TAPE.with(|tape| {
            tape.variables.borrow_mut().truncate(self.first_variable);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::super::Grad;
    use super::*;

    type Number = Real<Reverse>;

    /// A function over any kind of number.
    trait Function {
        fn of<K: Kind>(&self, x: &[Real<K>]) -> Real<K>;

        fn backwards(&self, at: &[f64]) -> Option<Vec<f64>> {
            let recording = Recording::begin();
            let x = at.iter().enumerate();
            let x: Vec<_> = x.map(|(i, &v)| Real::variable(v, i)).collect();
            let mut gradient = vec![0.0; at.len()];
            recording
                .gradient(&self.of::<Reverse>(&x), &mut gradient)
                .then_some(gradient)
        }

        fn forward(&self, at: &[f64]) -> Vec<f64> {
            let x = at.iter().enumerate();
            let x: Vec<Real<Grad<4>>> =
                x.map(|(i, &v)| Real::variable(v, i)).collect();
            let y = self.of(&x);
            (0..at.len()).map(|i| y.partial(i)).collect()
        }
    }

    struct Mixed;

    impl Function for Mixed {
        fn of<K: Kind>(&self, x: &[Real<K>]) -> Real<K> {
            let mut sum = Real::new(0.0);
            // Some thousands of nodes: several sheets.
            for i in 0..1000 {
                let angle = x[0] * f64::from(i) + x[1] / x[2];
                sum += angle.sin() * x[3] - x[0] * x[0];
                sum += (x[1].max(x[2]) * 1e-3).exp() / (1.0 + sum * sum);
            }
            let terms = [(&x[0], 2.0), (&x[1], -1.0), (&x[0], 0.5)];
            sum + Real::combine(2.0, terms) + 0.0 * x[1]
        }
    }

    #[test]
    fn the_gradient_is_the_forward_one() {
        let at = [0.3, 1.7, 1.1, -0.4];
        let (found, known) =
            (Mixed.backwards(&at).unwrap(), Mixed.forward(&at));
        for (a, b) in found.iter().zip(&known) {
            // Round-off of a thousand terms.
            assert!((a - b).abs() < 1e-12 * known[0].abs(), "{a} {b}");
        }
        // Nothing is left over.
        assert_eq!(WRITTEN.with(|sheet| sheet.count.get()), 0);
        assert_eq!(Mixed.backwards(&at).unwrap(), found);
    }

    #[test]
    fn recordings_within_recordings_stand_apart() {
        let at = [0.3, 1.7, 1.1, -0.4];
        let alone = Mixed.backwards(&at).unwrap();
        let outer = Recording::begin();
        let x = Number::variable(3.0, 0);
        let mut product = x;
        for i in 0..700 {
            product = product * 0.9 + x.sin() * f64::from(i % 3);
            if i % 100 == 0 {
                assert_eq!(Mixed.backwards(&at).unwrap(), alone);
            }
        }
        let mut slope = [0.0];
        assert!(outer.gradient(&(product * x), &mut slope));
        let y = Real::<Grad<1>>::variable(3.0, 0);
        let known = (0..700)
            .fold(y, |product, i| product * 0.9 + y.sin() * f64::from(i % 3));
        let known = (known * y).partial(0);
        assert!((slope[0] - known).abs() < 1e-13 * known.abs());
    }

    #[test]
    fn numbers_of_elsewhere_are_lost() {
        let stray = Number::variable(1.0, 0);
        let own = Recording::begin();
        let x = Number::variable(2.0, 0);
        let mut slope = [0.0];
        assert!(own.gradient(&x.squared(), &mut slope));
        assert_eq!(slope, [4.0]);
        assert!(!own.gradient(&(x * stray), &mut slope));
        let inner = Recording::begin();
        let y = Number::variable(5.0, 0);
        assert!(!inner.gradient(&(y * x), &mut slope));
        drop(inner);
        assert!(!own.gradient(&(x + y), &mut slope));
        let moved = std::thread::spawn(move || x * x.exp() + 1.0 / x);
        let merged = moved.join().unwrap();
        assert!(own.gradient(&merged, &mut slope), "one node all along");
        let z = Number::variable(7.0, 1);
        let moved = std::thread::spawn(move || x * z);
        let lost = moved.join().unwrap();
        assert_eq!(lost.value(), 14.0);
        assert!(!own.gradient(&(lost + x), &mut slope));
        assert!(own.gradient(&(x * 0.0 + 3.0), &mut slope));
        assert_eq!(slope, [0.0]);
    }
}
