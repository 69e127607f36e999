//! Where on a floor the robot fits, and the ways from one point to another.

use pathfinding::prelude::astar;

use crate::geometry::{Point, Segment};
use crate::map::{Cell, OccupancyGrid};
use crate::tiago::RobotModel;

/// Clearance beyond the robot's radius that a planned way keeps where it can, in metres.
const COMFORT: f64 = 0.25;

/// Clearance beyond the robot's radius that a planned way always keeps, in metres.
const MARGIN: f64 = 0.05;

/// Clearance beyond the robot's radius along the line between two neighbouring cells.
const EDGE_MARGIN: f64 = 0.02;

/// How far from a point its entry into the grid of fitting cells may be, in metres.
const ENTRY: f64 = 0.75;

/// Cost of a step straight or diagonal to the next cell: 100 and about 100 sqrt 2. The diagonal is
/// rounded down, so that the octile heuristic stays admissible.
const STRAIGHT: u64 = 100;
const DIAGONAL: u64 = 141;

/// A disc that is in the way for a while.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Disc {
    pub(crate) center: Point,
    /// Distance that the robot's middle keeps from the disc's.
    pub(crate) keep: f64,
}

/// One floor, seen by a robot of a given size.
#[derive(Clone, Debug)]
pub(crate) struct Reach {
    radius: f64,
    /// For each cell, the number of king's moves to the nearest cell that is not free; cells off
    /// the map are not.
    moves: Vec<u16>,
    /// For each cell, whether the robot fits at its middle with the margin.
    fits: Vec<bool>,
}

impl Reach {
    pub(crate) fn new(map: &OccupancyGrid, model: &RobotModel) -> Self {
        let radius = model.radius;
        let moves = king_moves(map);
        // Between the middles of two neighbours, both at least `needed` clear, everything is at
        // least sqrt(needed^2 - half^2) clear: see to it that this is the edge margin.
        let half = map.resolution() * core::f64::consts::FRAC_1_SQRT_2;
        let edge = radius + EDGE_MARGIN;
        let needed = (radius + MARGIN).max((edge * edge + half * half).sqrt());
        let mut fits = Vec::with_capacity(moves.len());
        for row in 0..map.height() {
            for column in 0..map.width() {
                let far = moves.get(fits.len()).copied().unwrap_or(0);
                fits.push(
                    far > 0
                        && (at_least(far, map) >= needed
                            || map.disc_is_free(map.center(column, row), needed)),
                );
            }
        }
        Self { radius, moves, fits }
    }

    /// A lower bound of the distance from `p` to the nearest cell that is not free, in metres.
    pub(crate) fn clear_at_least(&self, map: &OccupancyGrid, p: Point) -> f64 {
        let cell = map.locate(p).and_then(|(c, r)| map.index(c, r));
        cell.and_then(|i| self.moves.get(i)).map_or(0.0, |&m| at_least(m, map))
    }

    /// Whether the robot fits at a point with a little room and can get from there to other cells.
    pub(crate) fn is_usable(&self, map: &OccupancyGrid, p: Point) -> bool {
        map.disc_is_free(p, self.radius + EDGE_MARGIN) && self.entry(map, p, &[]).is_some()
    }

    /// A way from `from` to `to` for the robot's middle: points joined by straight lines, both
    /// ends included. Keeps off the discs, except where the robot stands already.
    ///
    /// Deterministic: the search has integer costs and a fixed order of neighbours.
    pub(crate) fn way(
        &self,
        map: &OccupancyGrid,
        from: Point,
        to: Point,
        discs: &[Disc],
    ) -> Option<Vec<Point>> {
        if self.sees(map, from, to, self.radius + COMFORT, discs) {
            return Some(vec![from, to]);
        }
        let (start, goal) = (self.entry(map, from, discs)?, self.entry(map, to, discs)?);
        let (cells, _) = astar(
            &start,
            |&cell| self.steps(map, cell, discs),
            |&cell| octile(cell, goal),
            |&cell| cell == goal,
        )?;
        let mut points = Vec::with_capacity(cells.len() + 2);
        points.push((from, 0.0));
        points.extend(cells.iter().map(|&(c, r)| {
            let center = map.center(c, r);
            (center, self.clear_at_least(map, center))
        }));
        points.push((to, 0.0));
        Some(self.straightened(map, &points, discs))
    }

    /// Joins points that see each other, in two passes: first forward as far as the view goes
    /// without a break, then, over the few that are left, from each to the farthest it sees.
    fn straightened(&self, map: &OccupancyGrid, points: &[(Point, f64)], discs: &[Disc]) -> Vec<Point> {
        // A shortcut may come as near to a wall as what it cuts short, but no nearer than that or
        // the comfortable clearance. The given ends may be nearer to walls than any cell.
        let radius = |between: &[(Point, f64)]| {
            let inner = between.get(1..between.len().saturating_sub(1)).unwrap_or_default();
            let least = inner.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
            least.clamp(self.radius + MARGIN, self.radius + COMFORT)
        };
        let sees = |points: &[(Point, f64)], i: usize, j: usize| match (points.get(i), points.get(j)) {
            (Some(a), Some(b)) => {
                let radius = points.get(i..=j).map_or(f64::INFINITY, radius);
                self.sees(map, a.0, b.0, radius, discs)
            }
            _ => false,
        };
        let mut kept = vec![0];
        let mut at = 0;
        while at + 1 < points.len() {
            let mut next = at + 1;
            while next + 1 < points.len() && sees(points, at, next + 1) {
                next += 1;
            }
            kept.push(next);
            at = next;
        }
        let corners: Vec<(Point, f64)> = kept.iter().filter_map(|&i| points.get(i).copied()).collect();
        let mut way: Vec<Point> = corners.first().map(|c| c.0).into_iter().collect();
        let mut at = 0;
        while at + 1 < corners.len() {
            let far = (at + 2..corners.len()).rev().find(|&j| sees(&corners, at, j));
            at = far.unwrap_or(at + 1);
            way.extend(corners.get(at).map(|c| c.0));
        }
        way.dedup();
        way
    }

    /// Whether the robot's middle may go straight from `a` to `b` with a clearance of `radius`,
    /// or of what there is at the ends if that is less.
    fn sees(&self, map: &OccupancyGrid, a: Point, b: Point, radius: f64, discs: &[Disc]) -> bool {
        let ends = map.clearance(a, radius).min(map.clearance(b, radius)) - 1e-6;
        let segment = Segment { from: a, to: b };
        map.capsule_is_free(segment, radius.min(ends).max(self.radius)) && off_discs(segment, discs)
    }

    /// The nearest fitting cell to which the robot can go straight from `p`.
    fn entry(&self, map: &OccupancyGrid, p: Point, discs: &[Disc]) -> Option<(u32, u32)> {
        let (column, row) = map.locate(p)?;
        let mut reach: u32 = 1;
        while f64::from(reach) * map.resolution() < ENTRY {
            reach += 1;
        }
        let rows = row.saturating_sub(reach)..=row.saturating_add(reach).min(map.height() - 1);
        let columns = column.saturating_sub(reach)..=column.saturating_add(reach).min(map.width() - 1);
        let mut near: Vec<(f64, u32, u32)> = rows
            .flat_map(|r| columns.clone().map(move |c| (c, r)))
            .filter(|&(c, r)| self.fits_at(map, c, r))
            .map(|(c, r)| (map.center(c, r).distance_squared(p), c, r))
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
        let radius = map.clearance(p, self.radius + EDGE_MARGIN).max(self.radius + 2e-6) - 1e-6;
        near.into_iter().map(|(_, c, r)| (c, r)).find(|&(c, r)| {
            let segment = Segment { from: p, to: map.center(c, r) };
            map.capsule_is_free(segment, radius) && off_discs(segment, discs)
        })
    }

    fn fits_at(&self, map: &OccupancyGrid, column: u32, row: u32) -> bool {
        map.index(column, row).and_then(|i| self.fits.get(i)).copied().unwrap_or(false)
    }

    fn steps(&self, map: &OccupancyGrid, cell: (u32, u32), discs: &[Disc]) -> Vec<((u32, u32), u64)> {
        const AROUND: [(i64, i64); 8] =
            [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)];
        let here = map.center(cell.0, cell.1);
        let moved = |dc: i64, dr: i64| {
            let column = u32::try_from(i64::from(cell.0) + dc).ok()?;
            let row = u32::try_from(i64::from(cell.1) + dr).ok()?;
            self.fits_at(map, column, row).then_some((column, row))
        };
        AROUND
            .iter()
            .filter_map(|&(dc, dr)| {
                let to = moved(dc, dr)?;
                if dc != 0 && dr != 0 && (moved(dc, 0).is_none() || moved(0, dr).is_none()) {
                    return None;
                }
                let center = map.center(to.0, to.1);
                if !off_discs(Segment { from: here, to: center }, discs) {
                    return None;
                }
                let base = if dc == 0 || dr == 0 { STRAIGHT } else { DIAGONAL };
                // Up to three times the price next to a wall.
                let want = self.radius + 2.0 * COMFORT;
                let short = ((want - self.clear_at_least(map, center)) / want).clamp(0.0, 1.0);
                let dearer = u64::try_from(crate::map::floor_to_i64(short * 200.0)).unwrap_or(0);
                Some((to, base + base * dearer / STRAIGHT))
            })
            .collect()
    }
}

/// Whether a segment keeps off all discs; one that starts too near may only lead away.
pub(crate) fn off_discs(segment: Segment, discs: &[Disc]) -> bool {
    discs.iter().all(|disc| {
        let keep = disc.keep.min(segment.from.distance(disc.center) - 1e-9);
        segment.distance_squared(disc.center) >= keep * keep
    })
}

fn octile(a: (u32, u32), b: (u32, u32)) -> u64 {
    let (dc, dr) = (u64::from(a.0.abs_diff(b.0)), u64::from(a.1.abs_diff(b.1)));
    STRAIGHT * (dc.max(dr) - dc.min(dr)) + DIAGONAL * dc.min(dr)
}

/// Distance that any point of a cell is from the nearest cell that is not free, at least.
fn at_least(moves: u16, map: &OccupancyGrid) -> f64 {
    f64::from(moves.saturating_sub(1)) * map.resolution()
}

/// For each cell the number of king's moves to the nearest one that is not free: two sweeps.
fn king_moves(map: &OccupancyGrid) -> Vec<u16> {
    let mut moves: Vec<u16> =
        map.cells().iter().map(|&c| if c == Cell::Free { u16::MAX } else { 0 }).collect();
    let mut relax = |column: u32, row: u32, earlier: [(i64, i64); 4]| {
        let Some(index) = map.index(column, row) else { return };
        let mut least = moves.get(index).copied().unwrap_or(0);
        for (dc, dr) in earlier {
            let neighbor = u32::try_from(i64::from(column) + dc)
                .ok()
                .zip(u32::try_from(i64::from(row) + dr).ok())
                .and_then(|(c, r)| map.index(c, r))
                .and_then(|i| moves.get(i))
                .copied()
                .unwrap_or(0);
            least = least.min(neighbor.saturating_add(1));
        }
        if let Some(slot) = moves.get_mut(index) {
            *slot = least;
        }
    };
    for row in 0..map.height() {
        for column in 0..map.width() {
            relax(column, row, [(-1, 0), (-1, -1), (0, -1), (1, -1)]);
        }
    }
    for row in (0..map.height()).rev() {
        for column in (0..map.width()).rev() {
            relax(column, row, [(1, 0), (1, 1), (0, 1), (-1, 1)]);
        }
    }
    moves
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A room of 4 x 3 m with blocks in it.
    fn room() -> impl Strategy<Value = OccupancyGrid> {
        proptest::collection::vec((0..40u32, 0..30u32, 1..8u32, 1..8u32), 0..10).prop_map(|blocks| {
            let cells = (0..30u32).flat_map(|row| {
                let blocks = &blocks;
                (0..40u32).map(move |column| {
                    let inside = |&(c, r, w, h): &(u32, u32, u32, u32)| {
                        (c..c + w).contains(&column) && (r..r + h).contains(&row)
                    };
                    if blocks.iter().any(inside) { Cell::Occupied } else { Cell::Free }
                })
            });
            OccupancyGrid::new(40, 30, 0.1, Point::new(-1.0, 2.0), cells.collect()).unwrap()
        })
    }

    fn spot() -> impl Strategy<Value = Point> {
        (-0.9..2.9f64, 2.1..4.9f64).prop_map(|(x, y)| Point::new(x, y))
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

        #[test]
        fn a_way_is_free_for_the_robot_from_end_to_end(map in room(), from in spot(), to in spot()) {
            let model = RobotModel::TIAGO;
            let reach = Reach::new(&map, &model);
            prop_assume!(reach.is_usable(&map, from) && reach.is_usable(&map, to));
            let Some(way) = reach.way(&map, from, to, &[]) else { return Ok(()) };
            prop_assert_eq!((way[0], way[way.len() - 1]), (from, to));
            for pair in way.windows(2) {
                let segment = Segment { from: pair[0], to: pair[1] };
                prop_assert!(map.capsule_is_free(segment, model.radius + 1e-7));
            }
            prop_assert_eq!(reach.way(&map, from, to, &[]), Some(way));
        }

        #[test]
        fn a_way_exists_one_way_iff_it_exists_the_other(map in room(), from in spot(), to in spot()) {
            let reach = Reach::new(&map, &RobotModel::TIAGO);
            prop_assume!(reach.is_usable(&map, from) && reach.is_usable(&map, to));
            let there = reach.way(&map, from, to, &[]).is_some();
            prop_assert_eq!(there, reach.way(&map, to, from, &[]).is_some());
        }

        #[test]
        fn the_lower_bound_of_the_clearance_is_one(map in room(), p in spot()) {
            let reach = Reach::new(&map, &RobotModel::TIAGO);
            prop_assert!(reach.clear_at_least(&map, p) <= map.clearance(p, 10.0) + 1e-9);
        }

        #[test]
        fn a_way_keeps_off_discs(map in room(), from in spot(), to in spot(), center in spot()) {
            let reach = Reach::new(&map, &RobotModel::TIAGO);
            prop_assume!(reach.is_usable(&map, from) && reach.is_usable(&map, to));
            prop_assume!(from.distance(center) > 0.6 && to.distance(center) > 0.6);
            let Some(way) = reach.way(&map, from, to, &[Disc { center, keep: 0.6 }]) else { return Ok(()) };
            for pair in way.windows(2) {
                let off = Segment { from: pair[0], to: pair[1] }.distance_squared(center).sqrt();
                prop_assert!(off >= 0.6 - 1e-6, "{}", off);
            }
        }
    }
}
