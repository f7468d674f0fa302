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

/// The node of a number that depends on no variable.
const NONE: u32 = u32::MAX;

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
    slope: f64,
    node: u32,
    recording: u32,
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
        let recording = self.recording.get();
        Traced { value, slope: 1.0, node: count as u32, recording }
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
        Self { value, slope: f64::NAN, node: 0, recording: LOST }
    }

    #[inline(always)]
    fn is_same_node(&self, other: &Self) -> bool {
        self.node == other.node && self.recording == other.recording
    }

    /// A number made of two, with the slopes by their nodes. Numbers of
    /// another recording, as another thread may hand them over, are lost.
    #[inline(always)]
    fn join(value: f64, of: [&Self; 2], slopes: [f64; 2]) -> Self {
        WRITTEN.with(|sheet| {
            let recording = sheet.recording.get();
            if of.iter().any(|x| x.recording != recording) {
                return Self::lost(value);
            }
            let parents = of.map(|x| x.node);
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
        Traced { value, slope: 0.0, node: NONE, recording: NOTHING }
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

    /// A tape does not know what the directions are: lost to it.
    fn assemble(value: f64, _: impl Fn(usize) -> f64) -> Traced {
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
        x.node == NONE || x.slope == 0.0
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
        } else if x.is_same_node(&y) {
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
        if WRITTEN.with(|sheet| x.recording != sheet.recording.get()) {
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
        let nodes = &nodes[self.first_node..=x.node as usize];
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
