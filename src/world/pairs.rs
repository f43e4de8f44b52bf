//! What surfaces are made of, and how two of them touch.

use serde::{Deserialize, Serialize};

use super::WorldError;

/// What a surface is made of; the pair of two materials decides friction and restitution.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Material {
    /// A grain.
    Grain,
    /// Cylinder, floor, funnel, lid.
    Wall,
    /// The top plate.
    Plate,
    /// A piece of a laboratory with a friction of its own, by its number among these; else it is
    /// a wall.
    Piece(u8),
}

impl Material {
    /// Its number: that of its row in a table of pairs.
    pub fn index(self) -> usize {
        match self {
            Self::Grain => 0,
            Self::Wall => 1,
            Self::Plate => 2,
            Self::Piece(n) => 3 + usize::from(n),
        }
    }

    /// What it is but for its friction.
    fn kind(self) -> usize {
        match self {
            Self::Piece(_) => Self::Wall.index(),
            other => other.index(),
        }
    }
}

/// Friction and restitution of one pair of materials, both without unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PairCoefficients {
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// Coefficient of restitution.
    pub restitution: f64,
}

/// The coefficients of every pair of materials.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PairTable {
    /// Of grains, walls and plate.
    common: [[PairCoefficients; 3]; 3],
    /// Of each piece that has a friction of its own, against everything.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pieces: Vec<PairCoefficients>,
}

impl PairTable {
    /// The coefficients of a pair, whichever comes first.
    pub fn get(&self, a: Material, b: Material) -> PairCoefficients {
        let of = |n: u8| self.pieces.get(usize::from(n)).copied();
        let own = match (a, b) {
            // Of two, that of the smoother one.
            (Material::Piece(n), Material::Piece(m)) => {
                let both = of(n).zip(of(m));
                both.map(|(one, other)| if one.friction <= other.friction { one } else { other })
            }
            (Material::Piece(n), _) | (_, Material::Piece(n)) => of(n),
            _ => None,
        };
        own.unwrap_or(self.common[a.kind()][b.kind()])
    }

    /// The coefficients of every pair in both orders, row by row.
    pub fn values(&self) -> Vec<PairCoefficients> {
        let all = self.materials();
        all.iter().flat_map(|a| all.iter().map(|b| self.get(*a, *b))).collect()
    }

    /// Whether engines can take it.
    ///
    /// # Errors
    /// [`WorldError::BadSetting`] for negative friction or restitution outside 0 to 1.
    pub fn check(&self) -> Result<(), WorldError> {
        let sound = |p: &PairCoefficients| {
            p.friction >= 0.0 && p.friction.is_finite() && (0.0..=1.0).contains(&p.restitution)
        };
        let Some(bad) = self.values().into_iter().find(|p| !sound(p)) else { return Ok(()) };
        let PairCoefficients { friction, restitution } = bad;
        Err(WorldError::bad_setting(
            "contact",
            format!(
                "friction {friction} must be zero or more, restitution {restitution} from 0 to 1"
            ),
        ))
    }

    /// The table with one value for every pair.
    pub fn uniform(coefficients: PairCoefficients) -> Self {
        Self { common: [[coefficients; 3]; 3], pieces: Vec::new() }
    }

    /// Sets a pair of grains, walls and plate in both orders.
    pub fn set(&mut self, a: Material, b: Material, coefficients: PairCoefficients) {
        self.common[a.kind()][b.kind()] = coefficients;
        self.common[b.kind()][a.kind()] = coefficients;
    }

    /// Adds a piece with coefficients of its own; none where there are
    /// as many as can be told apart.
    pub fn add_piece(&mut self, coefficients: PairCoefficients) -> Option<Material> {
        let number = u8::try_from(self.pieces.len()).ok()?;
        self.pieces.push(coefficients);
        Some(Material::Piece(number))
    }

    /// Every material of the table, in the order of their numbers.
    pub fn materials(&self) -> Vec<Material> {
        let pieces = (0..self.pieces.len()).map(|n| Material::Piece(n as u8));
        [Material::Grain, Material::Wall, Material::Plate].into_iter().chain(pieces).collect()
    }
}
