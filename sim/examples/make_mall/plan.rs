//! The plan of the mall, in metres, and its drawing into images of the `map_server` format.

use selfneg_sim::pgm::Pgm;

/// Metres a pixel, and the unknown border around the building.
const RESOLUTION: f64 = 0.1;
const BORDER: f64 = 0.5;
const WIDTH: f64 = 28.0;
const DEPTH: f64 = 18.0;

const OCCUPIED: u16 = 0;
const UNKNOWN: u16 = 205;
const FREE: u16 = 254;

struct Canvas {
    columns: u32,
    rows: u32,
    samples: Vec<u16>,
}

impl Canvas {
    /// The building's rectangle: walls 0.2 m thick around a free inside.
    fn new() -> Self {
        let (columns, rows) = (290, 190);
        let mut canvas = Self { columns, rows, samples: vec![UNKNOWN; 290 * 190] };
        canvas.fill(0.0, 0.0, WIDTH, DEPTH, OCCUPIED);
        canvas.fill(0.2, 0.2, WIDTH - 0.2, DEPTH - 0.2, FREE);
        canvas
    }

    /// Gives `sample` to the pixels whose middles `inside` has; coordinates from the lower left
    /// corner of the building, in metres.
    fn paint(&mut self, sample: u16, inside: impl Fn(f64, f64) -> bool) {
        let pixels = (0..self.rows).rev().flat_map(|row| (0..self.columns).map(move |column| (column, row)));
        for ((column, row), slot) in pixels.zip(&mut self.samples) {
            let middle = |i: u32| (f64::from(i) + 0.5) * RESOLUTION - BORDER;
            if inside(middle(column), middle(row)) {
                *slot = sample;
            }
        }
    }

    fn fill(&mut self, x0: f64, y0: f64, x1: f64, y1: f64, sample: u16) {
        self.paint(sample, |x, y| x > x0 && x < x1 && y > y0 && y < y1);
    }

    fn block(&mut self, x0: f64, y0: f64, x1: f64, y1: f64) {
        self.fill(x0, y0, x1, y1, OCCUPIED);
    }

    fn open(&mut self, x0: f64, y0: f64, x1: f64, y1: f64) {
        self.fill(x0, y0, x1, y1, FREE);
    }

    fn round(&mut self, x: f64, y: f64, radius: f64) {
        self.paint(OCCUPIED, |px, py| (px - x) * (px - x) + (py - y) * (py - y) < radius * radius);
    }

    /// A wall along y between two x, 0.2 m thick, with a doorway.
    fn wall_with_door(&mut self, y: f64, x0: f64, x1: f64, door: f64) {
        self.block(x0, y - 0.1, x1, y + 0.1);
        self.open(door - 0.7, y - 0.1, door + 0.7, y + 0.1);
    }

    fn wall_across(&mut self, x: f64, y0: f64, y1: f64) {
        self.block(x - 0.1, y0, x + 0.1, y1);
    }

    /// The cabin that is in the same spot on both floors: door towards the hall, the shaft's
    /// machinery, never seen, behind it.
    fn elevator(&mut self) {
        self.block(13.0, 12.0, 15.4, 18.0);
        self.fill(13.2, 14.6, 15.2, 17.8, UNKNOWN);
        self.open(13.2, 12.2, 15.2, 14.4);
        self.open(13.6, 12.0, 14.8, 12.2);
    }

    fn image(self) -> Pgm {
        Pgm { width: self.columns, height: self.rows, maxval: 255, samples: self.samples }
    }
}

fn ground() -> Pgm {
    let mut c = Canvas::new();
    for x in [6.0, 11.0, 17.0, 23.0] {
        c.wall_across(x, 0.0, 5.1);
    }
    for x in [6.0, 21.5] {
        c.wall_across(x, 11.9, 18.0);
    }
    // Bakery, grocery, pharmacy, flowers; the lobby between them is open.
    c.wall_with_door(5.0, 0.0, 6.0, 3.2);
    c.wall_with_door(5.0, 6.0, 11.1, 8.6);
    c.wall_with_door(5.0, 16.9, 23.0, 19.6);
    c.wall_with_door(5.0, 23.0, 28.0, 25.6);
    // Bathroom, bookshop, shoes, offices.
    c.wall_with_door(12.0, 0.0, 6.0, 3.0);
    c.wall_with_door(12.0, 6.0, 13.2, 9.4);
    c.wall_with_door(12.0, 15.2, 21.5, 18.4);
    c.wall_with_door(12.0, 21.5, 28.0, 24.6);
    c.elevator();
    // Counters and shelves.
    c.block(0.8, 1.4, 4.6, 1.9);
    c.block(7.0, 1.2, 7.5, 3.6);
    c.block(8.5, 0.2, 9.0, 2.6);
    c.block(18.2, 1.4, 21.8, 1.9);
    c.block(22.3, 2.6, 22.9, 4.6);
    c.block(24.2, 0.8, 26.8, 1.4);
    c.block(7.2, 13.8, 7.7, 17.0);
    c.block(10.8, 13.8, 11.3, 17.0);
    c.block(16.4, 15.4, 20.4, 15.9);
    c.block(23.0, 15.0, 26.6, 16.2);
    // Wash basins, and the partitions of the cubicles.
    c.block(0.2, 12.9, 0.7, 15.0);
    for x in [1.7, 3.2, 4.7] {
        c.wall_across(x, 16.2, 18.0);
    }
    // The hall: a fountain, planters, benches, columns, the information desk.
    c.round(14.0, 8.6, 1.3);
    for x in [4.0, 22.6] {
        c.block(x, 8.2, x + 1.8, 9.0);
    }
    c.block(8.6, 7.0, 10.2, 7.5);
    c.block(18.0, 9.6, 19.6, 10.1);
    for x in [7.4, 20.6] {
        c.round(x, 10.8, 0.25);
        c.round(x, 6.2, 0.25);
    }
    c.block(12.4, 3.0, 12.9, 4.6);
    c.image()
}

fn upper() -> Pgm {
    let mut c = Canvas::new();
    for x in [6.0, 21.5] {
        c.wall_across(x, 11.9, 18.0);
    }
    for x in [12.0, 20.0] {
        c.wall_across(x, 0.0, 5.1);
    }
    // Bathroom, toys, clinic, hairdresser; the food court is open towards the hall.
    c.wall_with_door(12.0, 0.0, 6.0, 3.0);
    c.wall_with_door(12.0, 6.0, 13.2, 10.2);
    c.wall_with_door(12.0, 15.2, 21.5, 17.6);
    c.wall_with_door(12.0, 21.5, 28.0, 25.2);
    c.wall_with_door(5.0, 12.0, 20.1, 14.2);
    c.wall_with_door(5.0, 19.9, 28.0, 23.4);
    c.elevator();
    c.block(0.2, 12.9, 0.7, 15.0);
    for x in [1.7, 3.2, 4.7] {
        c.wall_across(x, 16.2, 18.0);
    }
    // Tables of the food court and its counter.
    for (x, y) in [(2.4, 3.4), (5.2, 2.6), (8.0, 3.4), (10.2, 2.2), (3.6, 5.6), (6.8, 5.8)] {
        c.round(x, y, 0.5);
    }
    c.block(1.0, 0.9, 10.6, 1.3);
    // The opening above the fountain, with its railing.
    c.block(12.2, 7.0, 15.8, 10.2);
    c.fill(12.4, 7.2, 15.6, 10.0, UNKNOWN);
    c.block(7.6, 14.4, 11.6, 14.9);
    c.block(16.0, 15.4, 18.6, 15.9);
    c.wall_across(19.6, 13.6, 18.0);
    c.block(23.2, 14.8, 23.7, 17.2);
    c.block(25.6, 14.8, 26.1, 17.2);
    // Rows of seats of the cinema.
    for y in [1.4, 2.4, 3.4] {
        c.block(22.0, y, 26.4, y + 0.3);
    }
    c.block(13.6, 1.2, 18.4, 1.7);
    c.round(20.2, 8.6, 0.7);
    c.block(23.4, 8.2, 25.0, 8.7);
    c.image()
}

/// The images, by file name.
pub(crate) fn images() -> [(&'static str, Vec<u8>); 2] {
    [("ground.pgm", ground().to_raw_bytes()), ("upper.pgm", upper().to_raw_bytes())]
}
