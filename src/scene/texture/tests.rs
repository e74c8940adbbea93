use std::path::Path;

use proptest::prelude::*;
use wgpu_types::{AddressMode, FilterMode, MipmapFilterMode};

use super::pattern::PatternImage;
use super::*;
use crate::scene::number::{f64_to_f32, i64_to_f64};

/// Four texels in a row with red 0, 1, 2, 3.
fn row(sampler: Sampler) -> Texture {
    let image = Image::new(4, 1, |x, _| [f64_to_f32(f64::from(x)), 0.0, 0.0, 1.0]).expect("4 x 1 is legal");
    Texture::new(image, sampler)
}

fn red(texture: &Texture, u: f32) -> f32 {
    texture.sample([u, 0.5], Footprint::default)[0]
}

#[test]
fn addressing_modes_repeat_mirror_clamp_and_show_a_border() {
    for (mode, expected) in [
        (AddressMode::Repeat, [2.0, 3.0, 0.0, 1.0, 2.0, 3.0, 0.0, 1.0]),
        (AddressMode::MirrorRepeat, [1.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 2.0]),
        (AddressMode::ClampToEdge, [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0]),
        (AddressMode::ClampToBorder, [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 0.0, 0.0]),
    ] {
        let texture = row(Sampler { filter: FilterMode::Nearest, address: [mode; 2], mips: None });
        let got = [-0.375, -0.125, 0.125, 0.375, 0.625, 0.875, 1.125, 1.375].map(|u| red(&texture, u));
        assert_eq!(got, expected, "{mode:?}, texels -2 to 5");
    }
}

#[test]
fn bilinear_gives_texels_at_their_centres_and_the_mean_half_way() {
    let texture = row(Sampler { address: [AddressMode::ClampToEdge; 2], ..Sampler::default() });
    assert_eq!(red(&texture, 0.375), 1.0, "centre of texel 1");
    assert_eq!(red(&texture, 0.5), 1.5, "between texels 1 and 2");
    assert_eq!(red(&texture, 0.4375), 1.25, "a quarter of the way");
}

#[test]
fn mips_average_boxes_down_to_one_texel_whatever_the_size() {
    for (width, height, levels) in [(4, 4, 3), (5, 3, 3), (1, 7, 3), (8, 1, 4)] {
        let image = Image::new(width, height, |x, y| [f64_to_f32(f64::from(x * 3 + y * y)); 4]).expect("legal size");
        let sum: f64 = image.texels().iter().map(|texel| f64::from(texel[0])).sum();
        let mean = sum / i64_to_f64(i64::from(width * height));
        let sampler = Sampler { mips: Some(MipmapFilterMode::Linear), ..Sampler::default() };
        let texture = Texture::new(image, sampler);
        assert_eq!(texture.levels().len(), levels, "levels of {width} x {height}");
        let last = f64::from(texture.levels()[levels - 1].texel(0, 0)[0]);
        assert!((last - mean).abs() < 1e-5 * mean, "{width} x {height}: last level {last}, mean {mean}");
    }
}

#[test]
fn mip_level_follows_the_longer_side_of_the_footprint() {
    let image = Image::new(4, 4, |x, _| [f64_to_f32(f64::from(x)); 4]).expect("legal size");
    let level = |mips, texels: f32| {
        let texture = Texture::new(image.clone(), Sampler { mips: Some(mips), ..Sampler::default() });
        let footprint = Footprint { dx: [texels / 4.0, 0.0], dy: [0.0, 0.25] };
        texture.sample([0.375, 0.375], || footprint)[0]
    };
    assert_eq!(level(MipmapFilterMode::Nearest, 1.0), 1.0, "one texel a pixel: level 0");
    assert_eq!(level(MipmapFilterMode::Nearest, 1.6), 1.0, "nearer to level 1, whose sample at u = 3/8 is 1");
    assert_eq!(level(MipmapFilterMode::Nearest, 4.0), 1.5, "the whole texture a pixel: its mean");
    assert_eq!(level(MipmapFilterMode::Linear, 3.0), 1.25, "half way between 1 and 1.5");
}

#[test]
fn srgb_decoding_matches_the_exact_curve_and_encoding_inverts_it() {
    for code in 0_u32..=255 {
        let exact = crate::format::srgb::decode(code).value;
        let ours = ColorSpace::Srgb.decode(f64::from(code) / 255.0);
        assert!((ours - exact).abs() <= 4.0 * f64::EPSILON * exact, "code {code}: {ours} for {exact}");
        assert_eq!(ColorSpace::Srgb.encode(ours, 255), code, "round trip of code {code}");
        assert_eq!(ColorSpace::Linear.encode(f64::from(code) / 255.0, 255), code, "linear round trip of {code}");
    }
}

#[test]
fn premultiplied_storage_keeps_alpha_and_multiplies_color_once() {
    let texel = [0.8, 0.4, 0.2, 0.5];
    let image = Image::new(1, 1, |_, _| texel).expect("legal size");
    let stored = |storage: Storage| storage.store(image.clone(), ColorSpace::Linear).texel(0, 0);
    assert_eq!(stored(Storage::AsIs), texel, "as it is");
    assert_eq!(stored(Storage::Premultiplied), [0.4, 0.2, 0.1, 0.5], "exact products");
    assert_eq!(stored(Storage::Premultiplied8)[0], 102.0 / 255.0, "0.8 * 0.5 * 255 = 102");
    assert_eq!(stored(Storage::Premultiplied8)[3], 128.0 / 255.0, "127.5 rounds to the even code 128");
    let back = stored(Storage::RoundTrip8)[2];
    assert!((back - 0.2).abs() > 1e-4, "8 bits lose some of the color: {back}");
}

#[test]
fn png_of_every_color_type_gives_the_same_grey() {
    use image::{DynamicImage, GrayAlphaImage, GrayImage, ImageBuffer, Luma, RgbImage, Rgba, RgbaImage};
    let (grey, alpha) = (51_u8, 255_u8);
    let wide: ImageBuffer<Luma<u16>, Vec<u16>> = ImageBuffer::from_pixel(2, 1, Luma([51 * 257]));
    let wide_rgba: ImageBuffer<Rgba<u16>, Vec<u16>> =
        ImageBuffer::from_pixel(2, 1, Rgba([51 * 257, 51 * 257, 51 * 257, 65535]));
    let images: [DynamicImage; 6] = [
        GrayImage::from_pixel(2, 1, Luma([grey])).into(),
        GrayAlphaImage::from_pixel(2, 1, image::LumaA([grey, alpha])).into(),
        RgbImage::from_pixel(2, 1, image::Rgb([grey; 3])).into(),
        RgbaImage::from_pixel(2, 1, Rgba([grey, grey, grey, alpha])).into(),
        wide.into(),
        wide_rgba.into(),
    ];
    for image in images {
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write_to(&mut bytes, image::ImageFormat::Png).expect("encoding to memory works");
        let bytes = bytes.into_inner();
        let read = png::decode(&bytes, Path::new("test.png"), ColorSpace::Linear).expect("a complete file");
        assert_eq!(read.texel(1, 0), [0.2, 0.2, 0.2, 1.0], "{:?}", image.color());
        for cut in 0..bytes.len() {
            let truncated = png::decode(&bytes[..cut], Path::new("cut.png"), ColorSpace::Linear);
            if let Err(error) = truncated {
                assert!(error.to_string().contains("cut.png"), "the message names the file: {error}");
            } else {
                assert!(bytes.len() - cut <= 16, "only the end chunk may be missing, not {} bytes", bytes.len() - cut);
            }
        }
    }
}

#[test]
fn sizes_beyond_the_limits_are_errors() {
    for (width, height) in [(0, 1), (1, 0), (MAX_TEXTURE_SIZE + 1, 1), (u32::MAX, u32::MAX)] {
        let error = Image::new(width, height, |_, _| [0.0; 4]).expect_err("no such texture");
        assert!(error.to_string().contains("1 to 4096"), "the message says what is possible: {error}");
    }
}

#[test]
fn shapes_have_opaque_and_transparent_parts_and_a_soft_edge() {
    for pattern in [Pattern::Leaf, Pattern::Grass, Pattern::Tree, Pattern::Radial, Pattern::FireAndSmoke] {
        let colors = [[0.2, 0.6, 0.1, 1.0], [0.3, 0.2, 0.1, if pattern == Pattern::Radial { 0.0 } else { 1.0 }]];
        let image = PatternImage { pattern, size: [64, 64], colors, cells: 5 };
        let alphas: Vec<u8> =
            (0..64).flat_map(|y| (0..64).map(move |x| (x, y))).map(|(x, y)| image.codes(x, y)[3]).collect();
        let count = |range: std::ops::RangeInclusive<u8>| alphas.iter().filter(|alpha| range.contains(alpha)).count();
        assert!(count(0..=0) > 200, "{pattern:?} leaves something out: {}", count(0..=0));
        assert!(count(230..=255) > 50, "{pattern:?} covers something: {}", count(230..=255));
        assert!(count(60..=190) > 50, "{pattern:?} has a soft edge: {}", count(60..=190));
    }
}

proptest! {
    #[test]
    fn any_coordinates_sample_within_the_range_of_the_texels(
        bits in prop::array::uniform6(any::<u32>()), mips in any::<bool>(), nearest in any::<bool>(), mode in 0_usize..4
    ) {
        let address = [AddressMode::Repeat, AddressMode::MirrorRepeat, AddressMode::ClampToEdge, AddressMode::ClampToBorder];
        let texture = row(Sampler {
            filter: if nearest { FilterMode::Nearest } else { FilterMode::Linear },
            address: [address[mode]; 2],
            mips: mips.then_some(MipmapFilterMode::Linear),
        });
        let [u, v, a, b, c, d] = bits.map(f32::from_bits);
        let [r, _, _, alpha] = texture.sample([u, v], || Footprint { dx: [a, b], dy: [c, d] });
        prop_assert!((0.0..=3.0).contains(&r) && (0.0..=1.0).contains(&alpha), "({}, {}) gives {}, {}", u, v, r, alpha);
    }

    #[test]
    fn encoding_is_the_nearest_code(linear in 0.0_f64..1.0) {
        let code = ColorSpace::Srgb.encode(linear, 255);
        let edge = |half: f64| ColorSpace::Srgb.decode(half / 255.0);
        prop_assert!(code == 0 || linear >= edge(f64::from(code) - 0.5), "code {} is too high", code);
        prop_assert!(code == 255 || linear < edge(f64::from(code) + 0.5), "code {} is too low", code);
    }
}
