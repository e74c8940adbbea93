//! The system's pixman, opened at run time, so that nothing needs it to build.

use std::ffi::{c_int, c_void};

use libloading::Library;

type Image = *mut c_void;
type Create = unsafe extern "C" fn(u32, c_int, c_int, *mut u32, c_int) -> Image;
type Unref = unsafe extern "C" fn(Image) -> c_int;
type Composite =
    unsafe extern "C" fn(c_int, Image, Image, Image, c_int, c_int, c_int, c_int, c_int, c_int, c_int, c_int);

/// `PIXMAN_a8b8g8r8`: RGBA bytes in memory on a little-endian machine.
const RGBA8: u32 = 0x2003_8888;

/// Operators, on premultiplied color.
#[derive(Clone, Copy)]
pub enum Operator {
    Over = 0x03,
    Xor = 0x0b,
    Add = 0x0c,
}

/// The functions used here.
pub struct Pixman {
    create: Create,
    unref: Unref,
    composite: Composite,
    /// Keeps the functions loaded.
    _library: Library,
}

impl Pixman {
    /// Opens the library; the error says why not.
    #[expect(unsafe_code, reason = "the library's initialisers and the signatures of pixman.h are trusted")]
    pub fn open() -> Result<Self, libloading::Error> {
        unsafe {
            let library = Library::new("libpixman-1.so.0")?;
            Ok(Self {
                create: *library.get(b"pixman_image_create_bits_no_clear\0")?,
                unref: *library.get(b"pixman_image_unref\0")?,
                composite: *library.get(b"pixman_image_composite32\0")?,
                _library: library,
            })
        }
    }

    /// Composites square images.
    #[expect(unsafe_code, reason = "both images are as large and as aligned as pixman is told")]
    pub fn composite(&self, operator: Operator, src: &[u8], dst: &mut [u8], width: usize) {
        assert!(src.len() == 4 * width * width && dst.len() == src.len(), "square RGBA images");
        assert!(src.as_ptr().cast::<u32>().is_aligned() && dst.as_ptr().cast::<u32>().is_aligned(), "aligned pixels");
        let side = c_int::try_from(width).expect("a small image");
        unsafe {
            let from = (self.create)(RGBA8, side, side, src.as_ptr().cast_mut().cast(), 4 * side);
            let to = (self.create)(RGBA8, side, side, dst.as_mut_ptr().cast(), 4 * side);
            assert!(!from.is_null() && !to.is_null(), "pixman has memory for two images");
            (self.composite)(operator as c_int, from, std::ptr::null_mut(), to, 0, 0, 0, 0, 0, 0, side, side);
            (self.unref)(from);
            (self.unref)(to);
        }
    }
}
