//! Draws a floor from above, with what is on it, as SVG. The same picture gives the same bytes.

use core::fmt::Write as _;

use crate::building::{Building, Floor};
use crate::geometry::{Point, sin_cos};
use crate::map::{Cell, OccupancyGrid};
use crate::person::Person;
use crate::story::Robot;
use crate::tiago::RobotModel;
use crate::world::World;

/// Pixels a metre.
const SCALE: f64 = 32.0;
/// Pixels above a floor for its title.
const TITLE: f64 = 46.0;
/// Pixels below a floor.
const FOOT: f64 = 18.0;
/// Pixels from one caption to the next.
const LINE: f64 = 25.0;

const CLOTHES: [&str; 6] = ["#c8553d", "#588b8b", "#8e6c8a", "#d9a13b", "#5b7db1", "#7a9e4b"];

/// One floor of a building from above: walls, furniture, places, and whatever is added.
#[derive(Clone, Debug)]
pub struct Picture<'a> {
    building: &'a Building,
    floor: usize,
    trail: Vec<Point>,
    way: Vec<Point>,
    robots: Vec<(Robot, RobotModel)>,
    people: Vec<Person>,
    marks: Vec<Mark>,
}

/// A spot with a label, told of below the floor.
#[derive(Clone, Debug)]
struct Mark {
    at: Point,
    label: String,
    caption: String,
}

impl<'a> Picture<'a> {
    /// A floor, by its index, with its places.
    #[must_use]
    pub fn new(building: &'a Building, floor: usize) -> Self {
        let (trail, way, robots, people, marks) = Default::default();
        Self { building, floor, trail, way, robots, people, marks }
    }

    /// A floor of a world as it is now: its people, and the robot with its way ahead if it is
    /// there.
    #[must_use]
    pub fn of(world: &'a World, floor: usize) -> Self {
        let mut picture = Self::new(world.building(), floor);
        picture.people = world.people().filter(|p| p.floor == floor).cloned().collect();
        if world.robot().floor == floor {
            picture.robots.push((*world.robot(), world.settings().model));
            picture.way = world.way_ahead();
        }
        picture
    }

    /// With a line where the robot has been.
    #[must_use]
    pub fn trail(mut self, trail: &[Point]) -> Self {
        self.trail = trail.to_vec();
        self
    }

    /// With a person more.
    #[must_use]
    pub fn person(mut self, person: &Person) -> Self {
        self.people.push(person.clone());
        self
    }

    /// With a spot marked by a short label, and a line of text for it below the floor. Marks
    /// closer than a robot's width share a disc.
    #[must_use]
    pub fn mark(mut self, at: Point, label: &str, caption: &str) -> Self {
        self.marks.push(Mark { at, label: label.to_owned(), caption: caption.to_owned() });
        self
    }

    /// Pixels below the floor.
    fn foot(&self) -> f64 {
        self.marks.iter().map(|_| LINE).sum::<f64>() + FOOT
    }

    /// The picture as an SVG document.
    #[must_use]
    pub fn to_svg(&self) -> String {
        svg(core::slice::from_ref(self))
    }
}

/// Several floors in one SVG document, one below the other in the order given. Floors that the
/// building does not have are left out.
#[must_use]
pub fn svg(pictures: &[Picture<'_>]) -> String {
    let floors: Vec<(&Picture<'_>, &Floor)> =
        pictures.iter().filter_map(|p| Some((p, p.building.floors().get(p.floor)?))).collect();
    let size = |map: &OccupancyGrid| {
        (
            f64::from(map.width()) * map.resolution() * SCALE,
            f64::from(map.height()) * map.resolution() * SCALE,
        )
    };
    let width = floors.iter().map(|(_, f)| size(&f.map).0).fold(0.0, f64::max);
    let height: f64 = floors.iter().map(|(p, f)| TITLE + size(&f.map).1 + p.foot()).sum();
    let mut out = Drawing { text: String::new() };
    out.line(&format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {width:.2} {height:.2}\" font-family=\"DejaVu Sans, Helvetica, Arial, sans-serif\">"
    ));
    out.line(
        "<defs><pattern id=\"unseen\" width=\"8\" height=\"8\" patternUnits=\"userSpaceOnUse\" \
         patternTransform=\"rotate(45)\"><rect width=\"8\" height=\"8\" fill=\"#e4dfd3\"/>\
         <rect width=\"2\" height=\"8\" fill=\"#d6d0c1\"/></pattern></defs>",
    );
    out.line(&format!("<rect width=\"{width:.2}\" height=\"{height:.2}\" fill=\"#efebe1\"/>"));
    let mut top = 0.0;
    for (picture, floor) in floors {
        out.line(&format!("<g transform=\"translate(0 {:.2})\">", top + TITLE));
        out.title(picture.building, floor);
        out.floor(picture, floor);
        out.line("</g>");
        top += TITLE + size(&floor.map).1 + picture.foot();
    }
    out.line("</svg>");
    out.text
}

struct Drawing {
    text: String,
}

impl Drawing {
    fn line(&mut self, line: &str) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "{line}");
    }

    fn title(&mut self, building: &Building, floor: &Floor) {
        self.line(&format!(
            "<text x=\"18\" y=\"-15\" font-size=\"20\" fill=\"#2b3440\"><tspan font-weight=\"bold\">{}</tspan>\
             <tspan fill=\"#7b7466\" dx=\"6\">· {} floor</tspan></text>",
            escaped(building.name()),
            escaped(&floor.name)
        ));
        let right = f64::from(floor.map.width()) * floor.map.resolution() * SCALE - 18.0;
        let left = right - 5.0 * SCALE;
        self.line(&format!(
            "<path d=\"M{left:.2} -24v8H{right:.2}v-8\" fill=\"none\" stroke=\"#7b7466\" stroke-width=\"1.5\"/>\
             <text x=\"{:.2}\" y=\"-22\" font-size=\"12\" fill=\"#7b7466\" text-anchor=\"middle\">5 m</text>",
            f64::midpoint(left, right)
        ));
    }

    fn floor(&mut self, picture: &Picture<'_>, floor: &Floor) {
        let map = &floor.map;
        let layers = Layers::of(map);
        let fills = [
            (Layer::Unknown, "url(#unseen)"),
            (Layer::Free, "#fffdf8"),
            (Layer::Furniture, "#c9b79c"),
            (Layer::Wall, "#3a4654"),
        ];
        for (layer, fill) in fills {
            let path = layers.path(map, layer);
            if !path.is_empty() {
                self.line(&format!("<path d=\"{path}\" fill=\"{fill}\" shape-rendering=\"crispEdges\"/>"));
            }
        }
        for elevator in picture.building.elevators() {
            for stop in elevator.stops.iter().filter(|s| s.floor == picture.floor) {
                let (x, y) = pixel(map, stop.position);
                self.line(&format!(
                    "<g transform=\"translate({x:.2} {y:.2})\"><rect x=\"-21\" y=\"-21\" width=\"42\" height=\"42\" rx=\"5\" \
                     fill=\"#dfe7ee\" stroke=\"#9fb0c0\"/><path d=\"M-7 -3l7 -9l7 9zM-7 3l7 9l7 -9z\" fill=\"#7d91a5\"/></g>"
                ));
            }
        }
        let trail = polyline(map, &picture.trail);
        self.line(&format!(
            "<path d=\"{trail}\" fill=\"none\" stroke=\"#2f7fb5\" stroke-opacity=\"0.22\" stroke-width=\"{:.2}\" \
             stroke-linecap=\"round\" stroke-linejoin=\"round\"/><path d=\"{trail}\" fill=\"none\" stroke=\"#2f7fb5\" \
             stroke-width=\"2.5\" stroke-linecap=\"round\" stroke-linejoin=\"round\"/>",
            2.0 * RobotModel::TIAGO.radius * SCALE
        ));
        self.line(&format!(
            "<path d=\"{}\" fill=\"none\" stroke=\"#e08a2c\" stroke-width=\"2.5\" stroke-dasharray=\"7 6\" \
             stroke-linejoin=\"round\"/>",
            polyline(map, &picture.way)
        ));
        for place in &floor.places {
            let (x, y) = pixel(map, place.position);
            self.line(&format!(
                "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"5\" fill=\"#fff\" stroke=\"#1f8a70\" stroke-width=\"2.5\"/>"
            ));
        }
        for (person, color) in picture.people.iter().zip(CLOTHES.iter().cycle()) {
            self.person(map, person, color);
        }
        for (robot, model) in &picture.robots {
            self.robot(map, robot, model);
        }
        for place in &floor.places {
            self.label(map, place.position, 21.0, &place.name, "#176b57");
        }
        for person in &picture.people {
            self.label(map, person.position, -14.0, &person.name, "#3b3a36");
        }
        self.marks(map, &picture.marks);
    }

    fn marks(&mut self, map: &OccupancyGrid, marks: &[Mark]) {
        let mut discs: Vec<(Point, String)> = Vec::new();
        for mark in marks {
            match discs.iter_mut().find(|(at, _)| at.distance(mark.at) < 2.0 * RobotModel::TIAGO.radius) {
                Some((_, labels)) => {
                    labels.push_str(" \u{b7} ");
                    labels.push_str(&mark.label);
                }
                None => discs.push((mark.at, mark.label.clone())),
            }
        }
        for (at, labels) in discs {
            let (x, y) = pixel(map, at);
            let half = half_pill(&labels) + 2.0;
            let width = f64::from(map.width()) * map.resolution() * SCALE;
            let x = if width > 2.0 * half { (x + 26.0).clamp(half, width - half) } else { x };
            self.pill(x, y - 22.0, &labels);
        }
        let mut y = f64::from(map.height()) * map.resolution() * SCALE + LINE;
        for mark in marks {
            self.pill(30.0, y - 5.0, &mark.label);
            self.line(&format!(
                "<text x=\"52\" y=\"{y:.2}\" font-size=\"15\" fill=\"#2b3440\">{}</text>",
                escaped(&mark.caption)
            ));
            y += LINE;
        }
    }

    /// A dark label with round ends around its middle.
    fn pill(&mut self, x: f64, y: f64, text: &str) {
        let half = half_pill(text);
        self.line(&format!(
            "<rect x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"20\" rx=\"10\" fill=\"#8c2f39\" stroke=\"#fffdf8\" \
             stroke-width=\"1.5\"/><text x=\"{x:.2}\" y=\"{:.2}\" font-size=\"13\" font-weight=\"bold\" fill=\"#fff\" \
             text-anchor=\"middle\">{}</text>",
            x - half,
            y - 10.0,
            2.0 * half,
            y + 4.6,
            escaped(text)
        ));
    }

    fn label(&mut self, map: &OccupancyGrid, at: Point, below: f64, text: &str, color: &str) {
        let (x, y) = pixel(map, at);
        // No longer than this in any usual typeface; kept on the picture.
        let half: f64 = 4.0 + text.chars().map(|_| 4.2).sum::<f64>();
        let width = f64::from(map.width()) * map.resolution() * SCALE;
        let x = if width > 2.0 * half { x.clamp(half, width - half) } else { x };
        self.line(&format!(
            "<text x=\"{x:.2}\" y=\"{:.2}\" font-size=\"13\" text-anchor=\"middle\" fill=\"{color}\" stroke=\"#fffdf8\" \
             stroke-width=\"3.5\" stroke-linejoin=\"round\" paint-order=\"stroke\">{}</text>",
            y + below,
            escaped(text)
        ));
    }

    fn person(&mut self, map: &OccupancyGrid, person: &Person, color: &str) {
        let (x, y) = pixel(map, person.position);
        let r = 1.25 * person.radius * SCALE;
        // Shoulders across the heading, a head, and a nose to show the way.
        self.line(&format!(
            "<g transform=\"translate({x:.2} {y:.2}) rotate({:.2})\"><ellipse rx=\"{:.2}\" ry=\"{r:.2}\" fill=\"{color}\" \
             stroke=\"#fff\" stroke-width=\"1.2\"/><path d=\"M{:.2} -2.5l4.5 2.5l-4.5 2.5z\" fill=\"#4a3b31\"/><circle r=\"{:.2}\" \
             fill=\"#4a3b31\"/></g>",
            -person.heading.to_degrees(),
            r * 0.62,
            r * 0.34,
            r * 0.42
        ));
    }

    fn robot(&mut self, map: &OccupancyGrid, robot: &Robot, model: &RobotModel) {
        let (x, y) = pixel(map, robot.pose.position);
        let r = model.radius * SCALE;
        let gaze = robot.joints.head_pan.position;
        let beam = |angle: f64| {
            let (sin, cos) = sin_cos(angle);
            (2.6 * r * cos, -2.6 * r * sin)
        };
        let ((x1, y1), (x2, y2)) = (beam(gaze + 0.35), beam(gaze - 0.35));
        self.line(&format!(
            "<g transform=\"translate({x:.2} {y:.2}) rotate({:.2})\"><path d=\"M0 0L{x1:.2} {y1:.2}L{x2:.2} {y2:.2}z\" \
             fill=\"#f2b134\" fill-opacity=\"0.6\"/><circle r=\"{r:.2}\" fill=\"#fff\" stroke=\"#24303c\" stroke-width=\"2.2\"/>\
             <path d=\"M{:.2} -4l6 4l-6 4z\" fill=\"#24303c\"/><circle r=\"{:.2}\" fill=\"#24303c\"/></g>",
            -robot.pose.heading.to_degrees(),
            r - 7.5,
            r * 0.42
        ));
        self.label(map, robot.pose.position, 24.0, "TIAGo", "#24303c");
    }
}

/// Pixels from the upper left corner of the map.
fn pixel(map: &OccupancyGrid, p: Point) -> (f64, f64) {
    ((p.x - map.origin().x) * SCALE, (map.far_corner().y - p.y) * SCALE)
}

fn polyline(map: &OccupancyGrid, points: &[Point]) -> String {
    let mut path = String::new();
    for (i, &p) in points.iter().enumerate() {
        let (x, y) = pixel(map, p);
        let _ = write!(path, "{}{x:.2} {y:.2}", if i == 0 { "M" } else { "L" });
    }
    path
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Layer {
    Free,
    Unknown,
    /// The largest connected set of occupied cells.
    Wall,
    /// All other occupied cells.
    Furniture,
}

struct Layers(Vec<Layer>);

impl Layers {
    fn of(map: &OccupancyGrid) -> Self {
        let mut layers: Vec<Layer> = map
            .cells()
            .iter()
            .map(|cell| match cell {
                Cell::Free => Layer::Free,
                Cell::Unknown => Layer::Unknown,
                Cell::Occupied => Layer::Furniture,
            })
            .collect();
        let mut seen = vec![false; layers.len()];
        let mut walls: Vec<usize> = Vec::new();
        for row in 0..map.height() {
            for column in 0..map.width() {
                let part = connected(map, (column, row), &mut seen);
                if part.len() > walls.len() {
                    walls = part;
                }
            }
        }
        for index in walls {
            if let Some(layer) = layers.get_mut(index) {
                *layer = Layer::Wall;
            }
        }
        Self(layers)
    }

    fn is(&self, map: &OccupancyGrid, column: u32, row: u32, layer: Layer) -> bool {
        map.index(column, row).and_then(|i| self.0.get(i)) == Some(&layer)
    }

    /// The cells of a layer as rectangles: runs in a row, joined with equal runs below.
    fn path(&self, map: &OccupancyGrid, layer: Layer) -> String {
        let mut path = String::new();
        let mut open: Vec<(u32, u32, u32)> = Vec::new();
        let side = map.resolution() * SCALE;
        let mut close = |(from, to, since): (u32, u32, u32), row: u32| {
            let (x, y) = (f64::from(from) * side, f64::from(map.height() - row) * side);
            let (w, h) = (f64::from(to - from) * side, f64::from(row - since) * side);
            let _ = write!(path, "M{x:.2} {y:.2}h{w:.2}v{h:.2}h-{w:.2}z");
        };
        for row in 0..=map.height() {
            let mut runs: Vec<(u32, u32)> = Vec::new();
            let mut start = None;
            for column in 0..=map.width() {
                match (start, self.is(map, column, row, layer)) {
                    (None, true) => start = Some(column),
                    (Some(from), false) => {
                        runs.push((from, column));
                        start = None;
                    }
                    _ => {}
                }
            }
            let mut still = Vec::new();
            for run in open {
                if runs.contains(&(run.0, run.1)) { still.push(run) } else { close(run, row) }
            }
            for (from, to) in runs {
                if !still.iter().any(|r| r.0 == from && r.1 == to) {
                    still.push((from, to, row));
                }
            }
            open = still;
        }
        path
    }
}

/// Half the width of a pill around a text.
fn half_pill(text: &str) -> f64 {
    6.0 + text.chars().map(|_| 4.2).sum::<f64>()
}

/// Indices of the occupied cells connected to a cell, if that is occupied and not yet seen.
fn connected(map: &OccupancyGrid, start: (u32, u32), seen: &mut [bool]) -> Vec<usize> {
    let mut part = Vec::new();
    let mut open = vec![start];
    while let Some((column, row)) = open.pop() {
        let Some(index) = map.index(column, row) else { continue };
        let Some(mark) = seen.get_mut(index) else { continue };
        if *mark || map.cell(column, row) != Some(Cell::Occupied) {
            continue;
        }
        *mark = true;
        part.push(index);
        open.extend(column.checked_sub(1).map(|c| (c, row)));
        open.extend(row.checked_sub(1).map(|r| (column, r)));
        open.push((column + 1, row));
        open.push((column, row + 1));
    }
    part
}
