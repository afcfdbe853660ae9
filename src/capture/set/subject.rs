//! Subjects and balls: one row for each, with all that is asked of it.

use std::fmt;

use super::word::Word;

/// What a shot shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Subject {
    /// The object whose shape is wanted.
    #[default]
    Object,
    /// A neutral matte ball: gives alpha, intensity and a second direction.
    GreySphere,
    /// A ball of the object's own paint: gives beta.
    MaterialSphere,
    /// A mirror ball: gives the direction.
    MirrorSphere,
    /// The mirror ball in another place: gives the positions of near lamps together with the first.
    MirrorSphereMoved,
    /// The cap on the lens: subtracted.
    Dark,
    /// A uniform field: divided by.
    FlatField,
    /// The grey ball under the lamp of one colour alone, seen in every channel: gives the crosstalk between them.
    Crosstalk,
}

/// What a ball is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SphereKind {
    /// Neutral and matte.
    #[default]
    Grey,
    /// The object's own paint.
    Material,
    /// A mirror.
    Mirror,
}

/// A value of a rig or a paint that a ball can give.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BallValue {
    /// The strength of each colour of a light over the reference colour's.
    Alpha,
    /// The paint's albedo in each colour over the reference colour's.
    Beta,
    /// The strength of a light over the first light's.
    Intensity,
    /// The direction to a light.
    Direction,
}

/// Whether a shot names its light, or its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Naming {
    /// It has to.
    Required,
    /// It can.
    Optional,
    /// It cannot.
    Refused,
}

/// All that is asked of a subject.
struct SubjectRow {
    /// How the file spells it, and what folders of its photos are called.
    word: &'static str,
    title: &'static str,
    /// The ball that fills its shots.
    sphere: Option<SphereKind>,
    /// Whether it sends on the light of every colour: such a subject is photographed in each.
    matte: bool,
    light: Naming,
    colour: Naming,
    /// Words that mean it by themselves in the names of files.
    names: &'static [&'static str],
}

/// All that is asked of a kind of ball.
struct SphereRow {
    word: &'static str,
    title: &'static str,
    /// The shots that it fills by itself.
    subject: Subject,
    /// What it is looked at for.
    gives: &'static [BallValue],
    /// Words that mean it in the names of files beside a word for a ball.
    made_of: &'static [&'static str],
}

impl Subject {
    const fn row(self) -> SubjectRow {
        use Naming::{Optional, Refused, Required};
        match self {
            Self::Object => SubjectRow {
                word: "object",
                title: "Object",
                sphere: None,
                matte: true,
                light: Required,
                colour: Required,
                names: &[
                    "object",
                    "obj",
                    "scene",
                    "sample",
                    "target",
                    "specimen",
                    "objekt",
                    "objekte",
                    "szene",
                    "motiv",
                    "objet",
                    "scène",
                    "échantillon",
                    "objeto",
                    "escena",
                    "muestra",
                    "oggetto",
                    "oggetti",
                    "scena",
                    "campione",
                    "物体",
                    "物件",
                    "对象",
                    "對象",
                    "样品",
                    "対象",
                    "対象物",
                    "被写体",
                    "試料",
                    "オブジェクト",
                ],
            },
            Self::GreySphere => SubjectRow {
                word: "grey-sphere",
                title: SphereKind::Grey.title(),
                sphere: Some(SphereKind::Grey),
                matte: true,
                light: Required,
                colour: Required,
                names: &["grey", "gray", "grau", "gris", "grise", "grigio", "grigia", "灰色", "グレー"],
            },
            Self::MaterialSphere => SubjectRow {
                word: "material-sphere",
                title: SphereKind::Material.title(),
                sphere: Some(SphereKind::Material),
                matte: true,
                light: Required,
                colour: Required,
                names: &["material", "paint"],
            },
            Self::MirrorSphere => SubjectRow {
                word: "mirror-sphere",
                title: SphereKind::Mirror.title(),
                sphere: Some(SphereKind::Mirror),
                matte: false,
                light: Required,
                colour: Optional,
                names: &[
                    "mirror",
                    "chrome",
                    "spiegel",
                    "chrom",
                    "miroir",
                    "espejo",
                    "specchio",
                    "light-probe",
                    "镜面",
                    "鏡面",
                    "ミラー",
                    "クロム",
                ],
            },
            Self::MirrorSphereMoved => SubjectRow {
                word: "mirror-sphere-moved",
                title: "Mirror ball, moved",
                sphere: Some(SphereKind::Mirror),
                matte: false,
                light: Required,
                colour: Optional,
                names: &[
                    "mirror-sphere-moved",
                    "mirror-ball-moved",
                    "mirror-moved",
                    "moved-mirror",
                    "moved-mirror-ball",
                    "moved-mirror-sphere",
                    "chrome-ball-moved",
                    "chrome-moved",
                    "spiegelkugel-versetzt",
                    "miroir-déplacé",
                    "espejo-movido",
                    "specchio-spostato",
                ],
            },
            Self::Dark => SubjectRow {
                word: "dark",
                title: "Dark frame",
                sphere: None,
                matte: false,
                light: Refused,
                colour: Refused,
                names: &[
                    "dark",
                    "dark-frame",
                    "black",
                    "dunkel",
                    "dunkelbild",
                    "oscuro",
                    "buio",
                    "暗场",
                    "暗電流",
                    "ダーク",
                ],
            },
            Self::FlatField => SubjectRow {
                word: "flat-field",
                title: "Flat field",
                sphere: None,
                matte: false,
                light: Optional,
                colour: Optional,
                names: &["flat-field", "flat", "white", "weißbild", "平场", "フラット"],
            },
            Self::Crosstalk => SubjectRow {
                word: "crosstalk",
                title: "Crosstalk",
                sphere: None,
                matte: false,
                light: Required,
                colour: Required,
                names: &["cross-talk", "übersprechen", "diaphonie", "diafonía", "diafonia", "串扰", "クロストーク"],
            },
        }
    }

    /// What the user calls it: "Grey ball".
    pub fn title(self) -> &'static str {
        self.row().title
    }

    /// The kind of ball that fills this subject's shots. One kind may fill several: see [`SphereKind::subject`].
    pub fn sphere_kind(self) -> Option<SphereKind> {
        self.row().sphere
    }

    /// Whether it is photographed in every colour.
    pub fn is_matte(self) -> bool {
        self.row().matte
    }

    /// Whether it is a ball that mirrors its surroundings: all but the highlight is dark there.
    pub fn is_shiny_ball(self) -> bool {
        self.sphere_kind().is_some() && !self.is_matte()
    }

    /// Whether its shots name their light.
    pub fn light(self) -> Naming {
        self.row().light
    }

    /// Whether its shots name their colour.
    pub fn colour(self) -> Naming {
        self.row().colour
    }

    /// Words that mean it by themselves in the names of files; a hyphen stands for any or no separator.
    pub(super) fn names(self) -> &'static [&'static str] {
        self.row().names
    }
}

impl SphereKind {
    const fn row(self) -> SphereRow {
        use BallValue::{Alpha, Beta, Direction, Intensity};
        match self {
            Self::Grey => SphereRow {
                word: "grey",
                title: "Grey ball",
                subject: Subject::GreySphere,
                gives: &[Alpha, Intensity, Direction],
                made_of: &[
                    "grey",
                    "gray",
                    "grau",
                    "graue",
                    "gris",
                    "grise",
                    "grigio",
                    "grigia",
                    "grigie",
                    "neutral",
                    "灰",
                    "灰色",
                    "グレー",
                    "グレイ",
                ],
            },
            Self::Material => SphereRow {
                word: "material",
                title: "Ball of the paint",
                subject: Subject::MaterialSphere,
                gives: &[Beta],
                made_of: &[
                    "material",
                    "paint",
                    "painted",
                    "farb",
                    "lack",
                    "lackierte",
                    "peinte",
                    "peinture",
                    "pintada",
                    "pintura",
                    "verniciata",
                    "materiale",
                    "涂料",
                    "塗料",
                    "塗装",
                    "材料",
                ],
            },
            Self::Mirror => SphereRow {
                word: "mirror",
                title: "Mirror ball",
                subject: Subject::MirrorSphere,
                gives: &[Direction],
                made_of: &[
                    "mirror",
                    "mirrored",
                    "chrome",
                    "chromed",
                    "steel",
                    "black",
                    "glossy",
                    "shiny",
                    "spiegel",
                    "spiegelnde",
                    "chrom",
                    "stahl",
                    "schwarze",
                    "miroir",
                    "chromée",
                    "acier",
                    "noire",
                    "espejo",
                    "cromo",
                    "cromada",
                    "acero",
                    "negra",
                    "specchio",
                    "cromata",
                    "acciaio",
                    "nera",
                    "镜",
                    "镜面",
                    "铬",
                    "钢",
                    "黑",
                    "鏡",
                    "鏡面",
                    "ミラー",
                    "クロム",
                    "黒",
                ],
            },
        }
    }

    /// What the user calls it: "Grey ball".
    pub const fn title(self) -> &'static str {
        self.row().title
    }

    /// The shots that a ball of this kind fills by itself, in its first place.
    pub fn subject(self) -> Subject {
        self.row().subject
    }

    /// Words that mean it in the names of files beside a word for a ball.
    pub(super) fn made_of(self) -> &'static [&'static str] {
        self.row().made_of
    }

    /// Whether it is looked at for this value.
    pub fn gives(self, value: BallValue) -> bool {
        self.row().gives.contains(&value)
    }
}

impl Word for Subject {
    const ALL: &'static [Self] = &[
        Self::Object,
        Self::GreySphere,
        Self::MaterialSphere,
        Self::MirrorSphere,
        Self::MirrorSphereMoved,
        Self::Dark,
        Self::FlatField,
        Self::Crosstalk,
    ];

    fn word(self) -> &'static str {
        self.row().word
    }
}

impl Word for SphereKind {
    const ALL: &'static [Self] = &[Self::Grey, Self::Material, Self::Mirror];

    fn word(self) -> &'static str {
        self.row().word
    }
}

impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

impl fmt::Display for SphereKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}
