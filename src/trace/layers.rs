//! A floor's map as a grid, and its walls as points.

use selfneg_sim::{Cell, Floor};

use super::frames;
use super::schema::foxglove::packed_element_field::NumericType;
use super::schema::foxglove::{Grid, PackedElementField, PointCloud, Vector2};
use super::stamp::timestamp;
use std::time::Duration;

/// At which heights walls have points, in metres.
const HEIGHTS: [f32; 4] = [0.0, 0.5, 1.0, 1.5];

fn field(name: &str, offset: u32, kind: NumericType) -> PackedElementField {
    PackedElementField { name: name.to_owned(), offset, r#type: kind.into() }
}

/// One byte a cell, `occupancy`: 0 is free, 100 occupied, 255 unknown.
pub(super) fn grid(index: usize, floor: &Floor) -> Grid {
    let map = &floor.map;
    let byte = |cell: &Cell| match cell {
        Cell::Free => 0,
        Cell::Occupied => 100,
        Cell::Unknown => 255,
    };
    Grid {
        timestamp: timestamp(Duration::ZERO),
        frame_id: frames::floor(index),
        pose: frames::pose(map.origin(), 0.0, 0.0),
        column_count: map.width(),
        cell_size: Some(Vector2 { x: map.resolution(), y: map.resolution() }),
        row_stride: map.width(),
        cell_stride: 1,
        fields: vec![field("occupancy", 0, NumericType::Uint8)],
        data: map.cells().iter().map(byte).collect(),
    }
}

/// The cells at the borders of walls.
pub(super) fn walls(index: usize, floor: &Floor) -> PointCloud {
    let mut data = Vec::new();
    for point in floor.map.wall_points() {
        for z in HEIGHTS {
            for coordinate in [single(point.x), single(point.y), z] {
                data.extend(coordinate.to_le_bytes());
            }
        }
    }
    PointCloud {
        timestamp: timestamp(Duration::ZERO),
        frame_id: frames::floor(index),
        pose: frames::pose(selfneg_sim::Point::new(0.0, 0.0), 0.0, 0.0),
        point_stride: 12,
        fields: vec![
            field("x", 0, NumericType::Float32),
            field("y", 4, NumericType::Float32),
            field("z", 8, NumericType::Float32),
        ],
        data,
    }
}

/// Single precision is what viewers draw.
#[expect(
    clippy::cast_possible_truncation,
    reason = "rounds, to less than a tenth of a millimetre in a building"
)]
fn single(coordinate: f64) -> f32 {
    coordinate as f32
}
