//! Where laws and mechanisms are from, as far as their comments do not say.

/// The law and the paper, or what it is where there is none.
pub(crate) const LAWS: &[(&str, &str)] = &[
    ("coulomb", "Coulomb (1785), Théorie des machines simples."),
    (
        "turbulent",
        "Voellmy (1955), Über die Zerstörungskraft von Lawinen, \
         Schweizerische Bauzeitung 73.",
    ),
    (
        "voellmy",
        "Voellmy (1955), Über die Zerstörungskraft von Lawinen, \
         Schweizerische Bauzeitung 73; as Heredia et al. (2020) write it.",
    ),
    (
        "pcm",
        "Perla, Cheng and McClung (1980), A two-parameter model of \
         snow-avalanche motion, Journal of Glaciology 26(94).",
    ),
    (
        "cohesion",
        "Bartelt et al. (2015), Modelling cohesion in snow avalanche flow, \
         Journal of Glaciology 61(229).",
    ),
    ("viscous", "No paper: the linear term of a drag in powers of u."),
    (
        "velocity-weakening",
        "Lucas, Mangeney and Ampuero (2014), Frictional velocity-weakening \
         in landslides, Nature Communications 5:3417, for the effect; the \
         exponential form is a choice made here.",
    ),
    (
        "curvature",
        "Fischer, Kowalski and Pudasaini (2012), Topographic curvature \
         effects in applied avalanche modeling, Cold Regions Science and \
         Technology 74-75.",
    ),
    (
        "entrainment",
        "The balance of momentum of a mass that grows, as in Eglit and \
         Demidov (2005), Mathematical modeling of snow entrainment in \
         avalanche motion, Cold Regions Science and Technology 43.",
    ),
];

/// The mechanism and where it is from.
pub(crate) const MECHANISMS: &[(&str, &str)] = &[
    ("turbulent-drag", "The law [`turbulent`](../laws/turbulent.md)."),
    ("viscous-drag", "The law [`viscous`](../laws/viscous.md)."),
    ("cohesion", "The law [`cohesion`](../laws/cohesion.md)."),
    ("surge", BY_SHAPE),
    ("entrainment", "The law [`entrainment`](../laws/entrainment.md)."),
    ("depth-change", "The law [`turbulent`](../laws/turbulent.md)."),
    ("initial-velocity", OF_THE_DATA),
    ("release-position", OF_THE_DATA),
    ("clock-offset", OF_THE_DATA),
    ("velocity-scale", OF_THE_DATA),
    ("sensor-drift", OF_THE_DATA),
    (
        "spreading",
        "Savage and Hutter (1989), The motion of a finite mass of granular \
         material down a rough incline, Journal of Fluid Mechanics 199.",
    ),
    (
        "velocity-weakening",
        "The law [`velocity-weakening`](../laws/velocity-weakening.md).",
    ),
    ("friction-patch", BY_SHAPE),
    ("friction-step", BY_SHAPE),
    ("friction-hardening", BY_SHAPE),
    ("slope-bias", OF_THE_DATA),
    ("curvature", "The law [`curvature`](../laws/curvature.md)."),
    ("averaging-window", OF_THE_DATA),
];

const BY_SHAPE: &str = "No paper: a change of simple shape, which stands for \
                        causes that differ from slope to slope.";
const OF_THE_DATA: &str =
    "No paper: something that goes wrong when a run is measured.";

/// The entry of a name.
pub(crate) fn source(of: &[(&str, &'static str)], name: &str) -> &'static str {
    let entry = of.iter().find(|(known, _)| *known == name);
    entry.unwrap_or_else(|| panic!("no source of {name:?}: add one")).1
}
