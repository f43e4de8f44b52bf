//! What surfaces are made of, and how two of them touch.

use serde::{Deserialize, Serialize};

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
    /// Coulomb friction ratio.
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
