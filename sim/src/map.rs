//! Occupancy grids, and the map format of ROS `map_server` (a YAML file and a PGM image).
//!
//! The thresholds follow `map_server`'s trinary mode: with `p = (maxval - sample) / maxval`, or
//! `p = sample / maxval` if `negate` is set, a cell is occupied if `p > occupied_thresh`, free if
//! `p < free_thresh`, and unknown otherwise. The image's last row is the map's row 0.

use crate::error::{MapError, PgmError};
use crate::geometry::{Point, Rect, Segment, clip};
use crate::pgm::{MAX_PIXELS, MAX_SIDE, Pgm};
use crate::yaml::{self, Value};

/// Smallest cell that is read, in metres.
pub const MIN_RESOLUTION: f64 = 0.005;

/// Largest cell that is read, in metres.
pub const MAX_RESOLUTION: f64 = 1.0;

/// What is known of a cell.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Cell {
    /// Nothing is there.
    Free,
    /// Something is there.
    Occupied,
    /// Never seen. The robot treats it like an obstacle.
    Unknown,
}

/// A grid of square cells over a rectangle of a floor.
///
/// Cell (0, 0) is the lower left one. Whatever lies outside of the grid counts as not free.
#[derive(Clone, Debug, PartialEq)]
pub struct OccupancyGrid {
    width: u32,
    height: u32,
    resolution: f64,
    origin: Point,
    cells: Vec<Cell>,
}

impl OccupancyGrid {
    /// A grid of `width` x `height` cells, row by row from the bottom, each `resolution` metres
    /// wide, with its lower left corner at `origin`.
    ///
    /// # Errors
    ///
    /// [`MapError::SizeMismatch`], [`MapError::Resolution`] or [`MapError::Origin`].
    pub fn new(
        width: u32,
        height: u32,
        resolution: f64,
        origin: Point,
        cells: Vec<Cell>,
    ) -> Result<Self, MapError> {
        if !(MIN_RESOLUTION..=MAX_RESOLUTION).contains(&resolution) {
            return Err(MapError::Resolution { resolution });
        }
        if !(origin.x.abs() <= 1e6 && origin.y.abs() <= 1e6) {
            return Err(MapError::Origin);
        }
        let sides = 1..=MAX_SIDE;
        let area = usize::try_from(u64::from(width) * u64::from(height)).ok();
        if !sides.contains(&width)
            || !sides.contains(&height)
            || area != Some(cells.len())
            || cells.len() > MAX_PIXELS
        {
            return Err(MapError::SizeMismatch { width, height, cells: cells.len() });
        }
        Ok(Self { width, height, resolution, origin, cells })
    }

    /// Reads a map in the format of ROS `map_server`: the text of its YAML file, and `image`,
    /// which gives the bytes of the image that the file names.
    ///
    /// # Errors
    ///
    /// Any [`MapError`], or whatever `image` fails with.
    pub fn read<E: From<MapError>>(
        yaml: &str,
        image: impl FnOnce(&str) -> Result<Vec<u8>, E>,
    ) -> Result<Self, E> {
        let header = MapHeader::read(yaml)?;
        let bytes = image(&header.image)?;
        Ok(header.grid(&bytes)?)
    }

    /// Number of columns.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Number of rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Side of a cell, in metres.
    #[must_use]
    pub fn resolution(&self) -> f64 {
        self.resolution
    }

    /// Lower left corner, in metres.
    #[must_use]
    pub fn origin(&self) -> Point {
        self.origin
    }

    /// Upper right corner, in metres.
    #[must_use]
    pub fn far_corner(&self) -> Point {
        self.corner(self.width, self.height)
    }

    /// The cells, row by row from the bottom, as in `nav_msgs/OccupancyGrid`.
    #[must_use]
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// The cell in a column and row, if there is one.
    #[must_use]
    pub fn cell(&self, column: u32, row: u32) -> Option<Cell> {
        self.index(column, row).and_then(|i| self.cells.get(i)).copied()
    }

    /// The cell at a point, if the point is on the map.
    #[must_use]
    pub fn cell_at(&self, p: Point) -> Option<Cell> {
        self.locate(p).and_then(|(column, row)| self.cell(column, row))
    }

    /// The middle of a cell, in metres.
    #[must_use]
    pub fn center(&self, column: u32, row: u32) -> Point {
        Point::new(
            self.origin.x + (f64::from(column) + 0.5) * self.resolution,
            self.origin.y + (f64::from(row) + 0.5) * self.resolution,
        )
    }

    /// The middles of all occupied cells that touch one that is not: the walls as points to draw,
    /// row by row from the bottom.
    pub fn wall_points(&self) -> impl Iterator<Item = Point> + '_ {
        (0..self.height).flat_map(move |row| {
            (0..self.width)
                .filter(move |&column| {
                    self.cell(column, row) == Some(Cell::Occupied)
                        && self.neighbors(column, row).any(|n| n != Cell::Occupied)
                })
                .map(move |column| self.center(column, row))
        })
    }

    /// Whether a disc overlaps only free cells. Touching is not overlapping.
    #[must_use]
    pub fn disc_is_free(&self, center: Point, radius: f64) -> bool {
        self.capsule_is_free(Segment { from: center, to: center }, radius)
    }

    /// Distance from `p` to the nearest cell that is not free, in metres; at most `limit`.
    pub(crate) fn clearance(&self, p: Point, limit: f64) -> f64 {
        if self.locate(p).is_none() {
            return 0.0;
        }
        let mut least = limit * limit;
        self.visit_blocked(Segment { from: p, to: p }, limit, |rect| {
            least = least.min(rect.distance_squared(p));
            true
        });
        least.sqrt()
    }

    /// Whether a disc that moves along a segment overlaps only free cells.
    pub(crate) fn capsule_is_free(&self, segment: Segment, radius: f64) -> bool {
        if self.locate(segment.from).is_none() || self.locate(segment.to).is_none() {
            return false;
        }
        let limit = radius * radius;
        self.visit_blocked(segment, radius, |rect| rect.segment_distance_squared(segment) >= limit)
    }

    /// Shows `visit` every cell that is not free and at most `radius` away from the segment, and
    /// perhaps some further ones, until it gives `false`; then gives `false` too.
    ///
    /// The segment must lie on the map; then of all that is off the map the ring of cells around
    /// it is nearest, and further ones need no look.
    ///
    /// Row by row: only the part of the segment within `radius` of the row can be near to its
    /// cells, which bounds their columns.
    fn visit_blocked(&self, segment: Segment, radius: f64, mut visit: impl FnMut(Rect) -> bool) -> bool {
        let Segment { from, to } = segment;
        // One cell more on each side makes up for rounding.
        let reach = radius + self.resolution;
        let rows = self.span(from.y.min(to.y) - reach, from.y.max(to.y) + reach, self.origin.y, self.height);
        for row in rows.0..=rows.1 {
            let (low, high) = (self.edge(row, self.origin.y), self.edge(row + 1, self.origin.y));
            let part = clip((0.0, 1.0), from.y, to.y, low - reach, high + reach);
            if part.0 > part.1 {
                continue;
            }
            let (a, b) = (segment.from.towards(to, part.0).x, segment.from.towards(to, part.1).x);
            let columns = self.span(a.min(b) - reach, a.max(b) + reach, self.origin.x, self.width);
            for column in columns.0..=columns.1 {
                if self.is_free(column, row) {
                    continue;
                }
                let rect = Rect {
                    min: Point::new(self.edge(column, self.origin.x), low),
                    max: Point::new(self.edge(column + 1, self.origin.x), high),
                };
                if !visit(rect) {
                    return false;
                }
            }
        }
        true
    }

    /// Indices of the first and last cells that meet `low..=high` on an axis of `side` cells,
    /// counting one cell off the map at each end.
    fn span(&self, low: f64, high: f64, origin: f64, side: u32) -> (i64, i64) {
        let index = |v: f64| floor_to_i64((v - origin) / self.resolution).clamp(-1, i64::from(side));
        (index(low), index(high))
    }

    fn edge(&self, index: i64, origin: f64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "indices are far below 2^53")]
        let index = index as f64;
        origin + index * self.resolution
    }

    fn is_free(&self, column: i64, row: i64) -> bool {
        match (u32::try_from(column), u32::try_from(row)) {
            (Ok(column), Ok(row)) => self.cell(column, row) == Some(Cell::Free),
            _ => false,
        }
    }

    /// Column and row of the cell at a point, if it is on the map.
    pub(crate) fn locate(&self, p: Point) -> Option<(u32, u32)> {
        if !p.is_finite() {
            return None;
        }
        let column = u32::try_from(floor_to_i64((p.x - self.origin.x) / self.resolution)).ok()?;
        let row = u32::try_from(floor_to_i64((p.y - self.origin.y) / self.resolution)).ok()?;
        (column < self.width && row < self.height).then_some((column, row))
    }

    /// Position of a cell in [`OccupancyGrid::cells`].
    pub(crate) fn index(&self, column: u32, row: u32) -> Option<usize> {
        if column >= self.width || row >= self.height {
            return None;
        }
        usize::try_from(u64::from(row) * u64::from(self.width) + u64::from(column)).ok()
    }

    fn corner(&self, column: u32, row: u32) -> Point {
        Point::new(
            self.origin.x + f64::from(column) * self.resolution,
            self.origin.y + f64::from(row) * self.resolution,
        )
    }

    fn neighbors(&self, column: u32, row: u32) -> impl Iterator<Item = Cell> + '_ {
        let sides = [
            (column.checked_sub(1), Some(row)),
            (column.checked_add(1), Some(row)),
            (Some(column), row.checked_sub(1)),
            (Some(column), row.checked_add(1)),
        ];
        sides.into_iter().filter_map(|(c, r)| self.cell(c?, r?))
    }
}

/// The largest integer that is not above `value`, at the ends of the range of `i64` beyond it.
pub(crate) fn floor_to_i64(value: f64) -> i64 {
    // `as` saturates, and a cell index that far out is off every map.
    #[expect(clippy::cast_possible_truncation, reason = "saturates")]
    let floor = value.floor() as i64;
    floor
}

struct MapHeader {
    image: String,
    resolution: f64,
    origin: Point,
    negate: bool,
    occupied: f64,
    free: f64,
}

impl MapHeader {
    fn read(text: &str) -> Result<Self, MapError> {
        let root = yaml::parse(text)?;
        if let Some(mode) = root.get("mode")? {
            let mode = mode.text()?;
            if mode != "trinary" {
                return Err(MapError::Mode { mode: mode.to_owned() });
            }
        }
        let negate = match root.get("negate")? {
            None => false,
            Some(node) => match node.text()? {
                "0" | "false" => false,
                "1" | "true" => true,
                other => return Err(MapError::Negate { negate: other.to_owned() }),
            },
        };
        let number = |key| root.require(key)?.text().map(|t| t.parse::<f64>().unwrap_or(f64::NAN));
        let resolution = number("resolution")?;
        let (occupied, free) = (number("occupied_thresh")?, number("free_thresh")?);
        if !(0.0 <= free && free < occupied && occupied <= 1.0) {
            return Err(MapError::Thresholds { free, occupied });
        }
        let origin = root.require("origin")?;
        let origin = match &origin.value {
            Value::Sequence(numbers) => numbers.iter().map(yaml::Node::number).collect::<Result<Vec<_>, _>>(),
            _ => return Err(MapError::Origin),
        };
        let origin = match origin.as_deref() {
            Ok(&[x, y] | &[x, y, 0.0]) => Point::new(x, y),
            Ok(&[_, _, yaw]) => return Err(MapError::Rotated { yaw }),
            _ => return Err(MapError::Origin),
        };
        Ok(Self {
            image: root.require("image")?.text()?.to_owned(),
            resolution,
            origin,
            negate,
            occupied,
            free,
        })
    }

    fn grid(&self, image: &[u8]) -> Result<OccupancyGrid, MapError> {
        let image = Pgm::read(image)?;
        let width = usize::try_from(image.width)
            .map_err(|_| PgmError::Dimensions { width: image.width, height: image.height })?;
        let cells = image.samples.chunks_exact(width).rev().flatten().map(|&sample| {
            let dark = if self.negate { sample } else { image.maxval - sample };
            let p = f64::from(dark) / f64::from(image.maxval);
            if p > self.occupied {
                Cell::Occupied
            } else if p < self.free {
                Cell::Free
            } else {
                Cell::Unknown
            }
        });
        OccupancyGrid::new(image.width, image.height, self.resolution, self.origin, cells.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const HEADER: &str = "image: m.pgm\nresolution: 0.5\norigin: [-1.0, 2, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

    fn read(yaml: &str, image: &[u8]) -> Result<OccupancyGrid, MapError> {
        OccupancyGrid::read(yaml, |_| Ok(image.to_vec()))
    }

    fn grid() -> impl Strategy<Value = OccupancyGrid> {
        (1..12u32, 1..12u32).prop_flat_map(|(w, h)| {
            let cell =
                prop_oneof![4 => Just(Cell::Free), 1 => Just(Cell::Occupied), 1 => Just(Cell::Unknown)];
            proptest::collection::vec(cell, usize::try_from(w * h).unwrap())
                .prop_map(move |cells| OccupancyGrid::new(w, h, 0.25, Point::new(-0.3, 0.7), cells).unwrap())
        })
    }

    /// Every cell on the map and a ring of two around it, without the row-by-row search.
    fn slow_capsule_is_free(grid: &OccupancyGrid, segment: Segment, radius: f64) -> bool {
        let on_map = |p| grid.locate(p).is_some();
        if !on_map(segment.from) || !on_map(segment.to) {
            return false;
        }
        let (w, h) = (i64::from(grid.width()), i64::from(grid.height()));
        let cells = (-40..h + 40).flat_map(|row| (-40..w + 40).map(move |column| (column, row)));
        cells.filter(|&(column, row)| !grid.is_free(column, row)).all(|(column, row)| {
            let min = Point::new(grid.edge(column, grid.origin().x), grid.edge(row, grid.origin().y));
            let max = Point::new(grid.edge(column + 1, grid.origin().x), grid.edge(row + 1, grid.origin().y));
            Rect { min, max }.segment_distance_squared(segment) >= radius * radius
        })
    }

    proptest! {
        #[test]
        fn a_moving_disc_is_free_iff_no_cell_that_is_not_free_is_near(
            grid in grid(), a in (-1.0..3.0f64, 0.0..4.0f64), b in (-1.0..3.0f64, 0.0..4.0f64), radius in 0.01..0.8f64,
        ) {
            let segment = Segment { from: Point::new(a.0, a.1), to: Point::new(b.0, b.1) };
            prop_assert_eq!(grid.capsule_is_free(segment, radius), slow_capsule_is_free(&grid, segment, radius));
        }

        #[test]
        fn the_clearance_is_the_radius_of_the_largest_free_disc(
            grid in grid(), p in (-1.0..3.0f64, 0.0..4.0f64), limit in 0.05..1.0f64,
        ) {
            let p = Point::new(p.0, p.1);
            let clearance = grid.clearance(p, limit);
            prop_assert!(clearance <= limit);
            prop_assert!(clearance == 0.0 || grid.disc_is_free(p, clearance - 1e-9));
            prop_assert!(clearance == limit || !grid.disc_is_free(p, clearance + 1e-9));
        }

        #[test]
        fn a_cell_is_found_at_its_center(grid in grid()) {
            for row in 0..grid.height() {
                for column in 0..grid.width() {
                    prop_assert_eq!(grid.locate(grid.center(column, row)), Some((column, row)));
                }
            }
        }
    }

    #[test]
    fn samples_become_cells_as_in_map_server() {
        // 254 is what map_saver writes for free, 205 for unknown, 0 for occupied. The last row
        // of the image is the first of the map.
        let map = read(HEADER, b"P2 3 2 255  254 205 0  0 254 255").unwrap();
        use Cell::{Free, Occupied, Unknown};
        assert_eq!(map.cells(), [Occupied, Free, Free, Free, Unknown, Occupied]);
        assert_eq!(map.center(0, 0), Point::new(-0.75, 2.25));
        assert_eq!(map.cell_at(Point::new(-0.9, 2.9)), Some(Free));
        assert_eq!(map.cell_at(Point::new(-1.1, 2.9)), None);
        let negated = read(&HEADER.replace("negate: 0", "negate: 1"), b"P2 2 1 255  254 0").unwrap();
        assert_eq!(negated.cells(), [Occupied, Free]);
    }

    #[test]
    fn what_is_wrong_with_a_map_is_named() {
        let image = b"P2 1 1 255 254";
        let with = |from: &str, to: &str| read(&HEADER.replace(from, to), image).unwrap_err();
        assert_eq!(with("resolution: 0.5", "resolution: -0.5"), MapError::Resolution { resolution: -0.5 });
        assert!(matches!(with("resolution: 0.5", "resolution: .nan"), MapError::Resolution { .. }));
        assert!(matches!(with("resolution: 0.5", "resolution: 1e-300"), MapError::Resolution { .. }));
        for origin in ["[.nan, 0, 0]", "[nan, 0, 0]", "[1e9, 0, 0]", "[0]", "3", "[inf, 0]"] {
            assert_eq!(with("[-1.0, 2, 0.0]", origin), MapError::Origin, "{origin}");
        }
        assert_eq!(with("2, 0.0]", "2, 0.5]"), MapError::Rotated { yaw: 0.5 });
        assert!(matches!(with("0.196", "0.9"), MapError::Thresholds { .. }));
        assert!(matches!(with("0.196", "x"), MapError::Thresholds { .. }));
        assert_eq!(with("negate: 0", "mode: raw"), MapError::Mode { mode: "raw".into() });
        assert_eq!(with("negate: 0", "negate: maybe"), MapError::Negate { negate: "maybe".into() });
        assert!(matches!(with("image: m.pgm\n", ""), MapError::Yaml(_)));
        assert!(matches!(read("", image), Err(MapError::Yaml(_))));
        assert!(matches!(read("- a", image), Err(MapError::Yaml(_))));
        assert!(matches!(read(HEADER, b"P5 9 9 255\n"), Err(MapError::Pgm(_))));
        let two = OccupancyGrid::new(2, 2, 0.1, Point::default(), vec![Cell::Free; 3]);
        assert_eq!(two, Err(MapError::SizeMismatch { width: 2, height: 2, cells: 3 }));
    }

    #[test]
    fn nothing_is_free_where_coordinates_are_not_numbers() {
        let map = read(HEADER, b"P2 1 1 255 254").unwrap();
        assert!(!map.disc_is_free(Point::new(f64::NAN, 0.0), 0.1));
        assert!(!map.disc_is_free(Point::new(1e300, 0.0), 0.1));
        assert_eq!(map.locate(Point::new(f64::INFINITY, 0.0)), None);
    }

    #[test]
    fn walls_are_the_occupied_cells_at_a_border() {
        let mut cells = vec![Cell::Occupied; 25];
        cells[2] = Cell::Free;
        let map = OccupancyGrid::new(5, 5, 1.0, Point::default(), cells).unwrap();
        let points: Vec<Point> = map.wall_points().collect();
        assert_eq!(points, [Point::new(1.5, 0.5), Point::new(3.5, 0.5), Point::new(2.5, 1.5)]);
    }
}
