//! Floors from above, drawn from the trace's own maps.

use std::fmt::Write as _;

use maud::{Markup, html};

use super::super::page::Page;
use super::super::stage::{Floor, Mover, Pose, Shape};
use super::super::timeline::KeyMoment;
use super::seconds;

/// Units of the drawing a metre.
const SCALE: f64 = 20.0;
/// The robot's radius, in metres: TIAGo's base.
const ROBOT: f64 = 0.27;
/// A person's, in metres.
const PERSON: f64 = 0.25;
/// Marks closer than this share a disc, in metres.
const APART: f64 = 0.8;

/// Numbers on a disc; it says that there are more.
const MOST_ON_A_MARK: usize = 4;

/// All floors on which the robot was; an empty building tells nothing.
pub(super) fn floors(page: &Page, moments: &[KeyMoment]) -> Markup {
    html! {
        @for number in page.stage.visited() {
            @if let Some(floor) = page.stage.floors.get(number) {
                (figure(page, number, floor, moments))
            }
        }
        @if page.stage.robot().is_some() {
            p.legend {
                span { svg viewBox="0 0 30 10" aria-hidden="true" { path.gone d="M2 5H28" {} } " the robot’s way so far" }
                span { svg viewBox="0 0 30 10" aria-hidden="true" { path.way d="M2 5H28" {} } " in the whole run" }
                span { "pins: where it was at the numbered moments" }
            }
        }
        @if page.stage.visited().is_empty() {
            div.hidden {
                p { b { "Where the robot and people were is not shown." } }
                @if let Some(missing) = &page.missing { p { (missing.why) } }
            }
        }
    }
}

fn figure(page: &Page, number: usize, floor: &Floor, moments: &[KeyMoment]) -> Markup {
    let frame = Frame::of(floor);
    let name = match floor.name.as_str() {
        "" => format!("Floor {number}"),
        name => format!("{} floor", capital(name)),
    };
    let layers = Layers::of(floor);
    let movers = page.stage.movers.iter().filter(|mover| mover.is_ever_on(number));
    let marks = marks(page, number, moments);
    html! {
        figure.floor data-floor=(number) {
            figcaption { (name) }
            svg viewBox={ "0 0 " (unit(frame.width)) " " (unit(frame.height)) } role="img"
                aria-label={ (name) " from above, with the way of the robot and everybody where they were. The timeline tells the same in words." } {
                path.free d=(layers.path(floor, &frame, Layer::Free)) {}
                path.furniture d=(layers.path(floor, &frame, Layer::Furniture)) {}
                path.wall d=(layers.path(floor, &frame, Layer::Wall)) {}
                @if let Some(robot) = page.stage.robot() {
                    path.way d=(way(robot, number, &frame)) {}
                    path.gone d="" {}
                }
                @for place in &floor.places {
                    @let (x, y) = frame.at(place.x, place.y);
                    circle.place cx=(unit(x)) cy=(unit(y)) r="3" {}
                    text class={ "place " (frame.side(x, &place.name)) } x=(unit(x)) y=(unit(y + 15.0)) { (place.name) }
                }
                @for mover in movers { (figure_of(page, mover, number, &frame)) }
                @for mark in &marks {
                    @let (x, y) = frame.at(mark.x, mark.y);
                    g.mark transform={ "translate(" (unit(x)) " " (unit(y)) ")" } {
                        g.pin {
                            path d="M0 0L-5 -11H5z" {}
                            rect x=(unit(-mark.half_width())) y="-27" width=(unit(2.0 * mark.half_width())) height="17" rx="8.5" {}
                            text y="-14.5" { (mark.label) }
                        }
                    }
                }
            }
        }
    }
}

fn figure_of(page: &Page, mover: &Mover, floor: usize, frame: &Frame) -> Markup {
    let pose = mover.pose_at(page.opening).filter(|pose| pose.floor == floor);
    let transform = pose.map(|pose| {
        let (x, y) = frame.at(pose.x, pose.y);
        format!("translate({} {})", unit(x), unit(y))
    });
    let turn = format!("rotate({})", unit(-pose.map_or(0.0, |pose| pose.heading.to_degrees())));
    let name = match (&mover.name, &mover.shape) {
        (Some(name), _) => name.clone(),
        (None, Shape::Robot) => "robot".to_owned(),
        (None, Shape::User(number)) => format!("user {number}"),
        (None, Shape::Other(id)) => id.clone(),
    };
    let class = match mover.shape {
        Shape::Robot => "mover robot".to_owned(),
        Shape::User(number) => format!("mover person {}", tint(number)),
        Shape::Other(_) => "mover person bystander".to_owned(),
    };
    let radius = if mover.shape == Shape::Robot { ROBOT } else { PERSON } * SCALE;
    html! {
        g class=(class) data-track=(track(mover, floor, frame)) transform=[transform.as_deref()]
            visibility=[transform.is_none().then_some("hidden")] {
            g.turn transform=(turn) {
                circle r=(unit(radius)) {}
                path.nose d={ "M" (unit(radius * 1.6)) " 0L" (unit(radius * 0.5)) " " (unit(radius * 0.8)) "V" (unit(-radius * 0.8)) "z" } {}
            }
            // Below the robot, since marks are above it.
            text y=(unit(if mover.shape == Shape::Robot { radius + 14.0 } else { -radius - 5.0 })) { (name) }
        }
    }
}

/// The colour of a user, the same on the map and in tables.
pub(super) fn tint(user: u32) -> String {
    format!("tint-{}", user % 6)
}

/// `seconds x y degrees;` for each sample on this floor, `seconds;` for one elsewhere.
fn track(mover: &Mover, floor: usize, frame: &Frame) -> String {
    let mut track = String::new();
    let mut here = false;
    for sample in &mover.samples {
        match sample.pose.filter(|pose| pose.floor == floor) {
            Some(Pose { x, y, heading, .. }) => {
                let (x, y) = frame.at(x, y);
                let degrees = unit(-heading.to_degrees());
                // Writing to a string cannot fail.
                let _ = write!(track, "{} {} {} {degrees};", seconds(sample.at), unit(x), unit(y));
                here = true;
            }
            None if here => {
                let _ = write!(track, "{};", seconds(sample.at));
                here = false;
            }
            None => {}
        }
    }
    track
}

/// Everywhere the robot was on a floor.
fn way(robot: &Mover, floor: usize, frame: &Frame) -> String {
    let mut path = String::new();
    let mut last = None;
    let mut on = false;
    for sample in &robot.samples {
        let Some(pose) = sample.pose.filter(|pose| pose.floor == floor) else {
            on = false;
            continue;
        };
        let (x, y) = frame.at(pose.x, pose.y);
        let point = (unit(x), unit(y));
        if on && last.as_ref() == Some(&point) {
            continue;
        }
        let _ = write!(path, "{}{} {}", if on { 'L' } else { 'M' }, point.0, point.1);
        last = Some(point);
        on = true;
    }
    path
}

struct Mark {
    x: f64,
    y: f64,
    label: String,
    moments: usize,
}

impl Mark {
    fn half_width(&self) -> f64 {
        self.label.chars().map(|_| 3.4).sum::<f64>() + 5.2
    }
}

/// Where the robot was at the key moments.
fn marks(page: &Page, floor: usize, moments: &[KeyMoment]) -> Vec<Mark> {
    let mut marks: Vec<Mark> = Vec::new();
    let Some(robot) = page.stage.robot() else { return marks };
    for moment in moments {
        let Some(pose) = robot.pose_at(moment.at).filter(|pose| pose.floor == floor) else { continue };
        let close = |mark: &&mut Mark| libm::hypot(mark.x - pose.x, mark.y - pose.y) < APART;
        match marks.iter_mut().find(close) {
            Some(mark) => {
                mark.moments = mark.moments.saturating_add(1);
                match mark.moments {
                    ..=MOST_ON_A_MARK => {
                        let _ = write!(mark.label, " {}", moment.number);
                    }
                    more if more == MOST_ON_A_MARK.saturating_add(1) => mark.label.push_str(" …"),
                    _ => {}
                }
            }
            None => {
                let label = moment.number.to_string();
                marks.push(Mark { x: pose.x, y: pose.y, label, moments: 1 });
            }
        }
    }
    marks
}

/// From metres to the drawing, whose y-axis points down.
struct Frame {
    origin: (f64, f64),
    width: f64,
    height: f64,
    cell: f64,
}

impl Frame {
    fn of(floor: &Floor) -> Self {
        let cell = floor.resolution * SCALE;
        let rows = floor.cells.len().checked_div(floor.columns).unwrap_or(0);
        Self { origin: floor.origin, width: whole(floor.columns) * cell, height: whole(rows) * cell, cell }
    }

    /// Where a text belongs so that it does not leave the drawing: the class of its anchor.
    fn side(&self, x: f64, text: &str) -> &'static str {
        let half = text.chars().map(|_| 4.5).sum::<f64>();
        match (x - half < 0.0, x + half > self.width) {
            (false, true) => "right",
            (true, false) => "left",
            _ => "middle",
        }
    }

    fn at(&self, x: f64, y: f64) -> (f64, f64) {
        ((x - self.origin.0) * SCALE, self.height - (y - self.origin.1) * SCALE)
    }
}

/// Exact below 2^32, and maps are smaller.
fn whole(number: usize) -> f64 {
    u32::try_from(number).map_or(f64::from(u32::MAX), f64::from)
}

/// A number of the drawing, to a tenth.
fn unit(number: f64) -> String {
    let text = format!("{number:.1}");
    let short = text.strip_suffix(".0").unwrap_or(&text);
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

fn capital(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Layer {
    Free,
    Wall,
    Furniture,
    Unknown,
}

/// What each cell is. Walls are the largest connected part of what is occupied.
struct Layers(Vec<Layer>);

impl Layers {
    fn of(floor: &Floor) -> Self {
        let layer = |cell: &u8| match cell {
            0 => Layer::Free,
            100 => Layer::Furniture,
            _ => Layer::Unknown,
        };
        let mut layers: Vec<Layer> = floor.cells.iter().map(layer).collect();
        let mut seen = vec![false; layers.len()];
        let mut walls = Vec::new();
        for start in 0..layers.len() {
            let part = connected(&layers, floor.columns, start, &mut seen);
            if part.len() > walls.len() {
                walls = part;
            }
        }
        for cell in walls {
            if let Some(layer) = layers.get_mut(cell) {
                *layer = Layer::Wall;
            }
        }
        Self(layers)
    }

    /// The cells of a layer as rectangles: runs of a row, joined with equal runs above.
    fn path(&self, floor: &Floor, frame: &Frame, layer: Layer) -> String {
        let mut path = String::new();
        let mut open: Vec<(usize, usize, usize)> = Vec::new();
        let mut close = |(from, to, since): (usize, usize, usize), row: usize| {
            let (x, y) = (whole(from) * frame.cell, frame.height - whole(row) * frame.cell);
            let (w, h) = (whole(to - from) * frame.cell, whole(row - since) * frame.cell);
            let _ = write!(path, "M{} {}h{}v{}h-{}z", unit(x), unit(y), unit(w), unit(h), unit(w));
        };
        for (row, cells) in self.0.chunks(floor.columns).enumerate() {
            let runs = runs(cells, layer);
            let (kept, ended): (Vec<_>, Vec<_>) =
                open.into_iter().partition(|(from, to, _)| runs.contains(&(*from, *to)));
            for run in ended {
                close(run, row);
            }
            let since = |(from, to)| {
                let known = kept.iter().find(|run| (run.0, run.1) == (from, to));
                (from, to, known.map_or(row, |run| run.2))
            };
            open = runs.into_iter().map(since).collect();
        }
        let rows = self.0.len().checked_div(floor.columns).unwrap_or(0);
        for run in open {
            close(run, rows);
        }
        path
    }
}

/// First column of each run of a layer, and the one behind its last.
fn runs(cells: &[Layer], layer: Layer) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for column in (0_usize..).zip(cells).filter(|(_, cell)| **cell == layer).map(|(column, _)| column) {
        match runs.last_mut() {
            Some((_, end)) if *end == column => *end = column.saturating_add(1),
            _ => runs.push((column, column.saturating_add(1))),
        }
    }
    runs
}

/// The occupied cells connected to one, if that is occupied and not yet seen.
fn connected(layers: &[Layer], columns: usize, start: usize, seen: &mut [bool]) -> Vec<usize> {
    let mut part = Vec::new();
    let mut waiting = vec![start];
    while let Some(cell) = waiting.pop() {
        if layers.get(cell) != Some(&Layer::Furniture) {
            continue;
        }
        match seen.get_mut(cell) {
            Some(seen) if !*seen => *seen = true,
            _ => continue,
        }
        part.push(cell);
        let column = cell.checked_rem(columns).unwrap_or(0);
        if column > 0 {
            waiting.push(cell - 1);
        }
        if column.saturating_add(1) < columns {
            waiting.push(cell.saturating_add(1));
        }
        waiting.extend(cell.checked_sub(columns));
        waiting.push(cell.saturating_add(columns));
    }
    part
}
