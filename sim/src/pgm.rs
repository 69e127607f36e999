//! Portable grey maps: the plain (P2) and the raw (P5) format of Netpbm.

use crate::error::PgmError;

/// Largest width or height that is read, in pixels.
pub const MAX_SIDE: u32 = 8192;

/// Largest number of pixels that is read.
pub const MAX_PIXELS: usize = 1 << 24;

/// A grey image, top row first.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Pgm {
    /// Columns, 1 to [`MAX_SIDE`].
    pub width: u32,
    /// Rows, 1 to [`MAX_SIDE`].
    pub height: u32,
    /// The sample that means white, 1 to 65535.
    pub maxval: u16,
    /// `width * height` samples, each at most `maxval`, row by row from the top.
    pub samples: Vec<u16>,
}

struct Reader<'a> {
    rest: &'a [u8],
}

impl Reader<'_> {
    fn next_byte(&mut self) -> Option<u8> {
        let (&first, rest) = self.rest.split_first()?;
        self.rest = rest;
        Some(first)
    }

    /// The next decimal number, past white space and comments. Takes the one byte that ends it.
    fn number(&mut self) -> Result<Option<u32>, PgmError> {
        let mut value: Option<u32> = None;
        while let Some(byte) = self.next_byte() {
            match byte {
                b'0'..=b'9' => {
                    let digit = u32::from(byte - b'0');
                    let grown = value.unwrap_or(0).checked_mul(10).and_then(|v| v.checked_add(digit));
                    value = Some(grown.ok_or(PgmError::NumberTooLarge)?);
                }
                b'#' => {
                    while self.next_byte().is_some_and(|b| b != b'\n' && b != b'\r') {}
                    if value.is_some() {
                        return Ok(value);
                    }
                }
                _ if byte.is_ascii_whitespace() || byte == 0x0b => {
                    if value.is_some() {
                        return Ok(value);
                    }
                }
                _ => return Err(PgmError::UnexpectedByte { byte }),
            }
        }
        Ok(value)
    }
}

impl Pgm {
    /// Reads the first image in `bytes`, P2 or P5, 8 or 16 bits. Bytes after it are ignored, as
    /// Netpbm allows further images there.
    ///
    /// # Errors
    ///
    /// Any [`PgmError`]: another format, a header that is cut short or out of range, fewer
    /// samples than the header promises, a sample above `maxval`.
    pub fn read(bytes: &[u8]) -> Result<Self, PgmError> {
        let (plain, rest) = match bytes {
            [b'P', b'2', rest @ ..] => (true, rest),
            [b'P', b'5', rest @ ..] => (false, rest),
            _ => return Err(PgmError::NotPgm),
        };
        let mut reader = Reader { rest };
        let mut header = |what| reader.number()?.ok_or(PgmError::HeaderCutShort { missing: what });
        let (width, height, maxval) = (header("width")?, header("height")?, header("maxval")?);
        if width == 0 || height == 0 || width > MAX_SIDE || height > MAX_SIDE {
            return Err(PgmError::Dimensions { width, height });
        }
        let expected = match usize::try_from(u64::from(width) * u64::from(height)) {
            Ok(pixels) if pixels <= MAX_PIXELS => pixels,
            _ => return Err(PgmError::Dimensions { width, height }),
        };
        let maxval = match u16::try_from(maxval) {
            Ok(maxval) if maxval > 0 => maxval,
            _ => return Err(PgmError::Maxval { maxval }),
        };
        let samples: Vec<u16> = if plain {
            plain_samples(reader, expected)?
        } else if maxval < 256 {
            reader.rest.iter().take(expected).map(|&b| u16::from(b)).collect()
        } else {
            reader.rest.as_chunks().0.iter().take(expected).map(|&pair| u16::from_be_bytes(pair)).collect()
        };
        if samples.len() < expected {
            return Err(PgmError::Truncated { expected, found: samples.len() });
        }
        if let Some(&sample) = samples.iter().find(|&&s| s > maxval) {
            return Err(PgmError::SampleAboveMaxval { sample: u32::from(sample), maxval });
        }
        Ok(Self { width, height, maxval, samples })
    }

    /// The image as raw PGM (P5) with 8 bits a sample; samples are clamped to 255.
    #[must_use]
    pub fn to_raw_bytes(&self) -> Vec<u8> {
        let maxval = self.maxval.min(255);
        let mut bytes = format!("P5\n{} {}\n{maxval}\n", self.width, self.height).into_bytes();
        bytes.extend(self.samples.iter().map(|&s| u8::try_from(s).unwrap_or(u8::MAX)));
        bytes
    }
}

fn plain_samples(mut reader: Reader<'_>, expected: usize) -> Result<Vec<u16>, PgmError> {
    // A sample takes at least two bytes, so what is reserved is bounded by what was given.
    let mut samples = Vec::with_capacity(expected.min(reader.rest.len()));
    while samples.len() < expected {
        match reader.number()? {
            Some(n) => {
                samples.push(
                    u16::try_from(n)
                        .map_err(|_| PgmError::SampleAboveMaxval { sample: n, maxval: u16::MAX })?,
                );
            }
            None => break,
        }
    }
    Ok(samples)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn image() -> impl Strategy<Value = Pgm> {
        (1..9u32, 1..9u32, 1..=255u16).prop_flat_map(|(width, height, maxval)| {
            proptest::collection::vec(0..=maxval, usize::try_from(width * height).unwrap())
                .prop_map(move |samples| Pgm { width, height, maxval, samples })
        })
    }

    fn plain(image: &Pgm) -> String {
        let samples: Vec<String> = image.samples.iter().map(u16::to_string).collect();
        format!(
            "P2 # plain\n{} {} # size\n{}\n{}",
            image.width,
            image.height,
            image.maxval,
            samples.join("\n")
        )
    }

    proptest! {
        #[test]
        fn both_formats_read_back(image in image()) {
            prop_assert_eq!(&Pgm::read(&image.to_raw_bytes()).unwrap(), &image);
            prop_assert_eq!(&Pgm::read(plain(&image).as_bytes()).unwrap(), &image);
        }

        #[test]
        fn every_proper_prefix_of_a_raw_image_is_an_error(image in image(), cut: prop::sample::Index) {
            let bytes = image.to_raw_bytes();
            let keep = cut.index(bytes.len());
            prop_assert!(Pgm::read(&bytes[..keep]).is_err());
        }

        #[test]
        fn no_bytes_make_it_panic(bytes in proptest::collection::vec(any::<u8>(), 0..80), raw in any::<bool>()) {
            let mut all = if raw { b"P5 ".to_vec() } else { b"P2 ".to_vec() };
            all.extend(bytes);
            let _ = Pgm::read(&all);
        }
    }

    #[test]
    fn sixteen_bits_are_big_endian() {
        let image = Pgm::read(b"P5 2 1 1000\n\x03\xe8\x00\x01").unwrap();
        assert_eq!(image.samples, [1000, 1]);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let read = |bytes: &[u8]| Pgm::read(bytes).unwrap_err();
        assert_eq!(read(b"P6 1 1 255\n..."), PgmError::NotPgm);
        assert_eq!(read(b"P5 3"), PgmError::HeaderCutShort { missing: "height" });
        assert_eq!(read(b"P5 0 4 255\n"), PgmError::Dimensions { width: 0, height: 4 });
        assert_eq!(read(b"P5 8000 8000 255\n"), PgmError::Dimensions { width: 8000, height: 8000 });
        assert_eq!(read(b"P5 99999999999 1 255\n"), PgmError::NumberTooLarge);
        assert_eq!(read(b"P5 1 1 0\nx"), PgmError::Maxval { maxval: 0 });
        assert_eq!(read(b"P5 2 2 255\nabc"), PgmError::Truncated { expected: 4, found: 3 });
        assert_eq!(read(b"P5 1 1 9\nx"), PgmError::SampleAboveMaxval { sample: 120, maxval: 9 });
        assert_eq!(read(b"P2 1 1 9 -1"), PgmError::UnexpectedByte { byte: b'-' });
    }
}
