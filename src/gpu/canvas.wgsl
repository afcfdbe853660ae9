// Turns planes of linear light into the colours of a canvas. `colour.rs` and `twin.rs` say the same in Rust.

// Field by field the `Uniforms` of uniforms.rs, where units are given.
struct Canvas {
    origin_px: vec2<f32>,
    scale: f32,
    texel_size: f32,
    size: vec2<f32>,
    range: vec2<f32>,
    mip: u32,
    nearest: u32,
    map: u32,
    negative_zebra: u32,
    clip: f32,
    mask_dimming: f32,
    exponent: f32,
    gain: f32,
    background: vec4<f32>,
    tints: array<vec4<f32>, 8>,
    weights: array<vec4<f32>, 12>,
}

// Fixed when the pipeline is made: what a drawing does not use costs it nothing, not even on cards that run both sides of a
// branch.
override PLANE_COUNT: u32 = 1u;
override KIND: u32 = 0u;
override IS_GREY: bool = true;
override HAS_MARKS: bool = false;
override HAS_MASK: bool = false;

@group(0) @binding(0) var<uniform> canvas: Canvas;
@group(0) @binding(1) var colour_maps: texture_2d<f32>;
@group(0) @binding(2) var marks: texture_2d<u32>;
@group(0) @binding(3) var mask: texture_2d<u32>;
@group(0) @binding(4) var plane_0: texture_2d<f32>;
@group(0) @binding(5) var plane_1: texture_2d<f32>;
@group(0) @binding(6) var plane_2: texture_2d<f32>;
@group(0) @binding(7) var plane_3: texture_2d<f32>;
@group(0) @binding(8) var plane_4: texture_2d<f32>;
@group(0) @binding(9) var plane_5: texture_2d<f32>;
@group(0) @binding(10) var plane_6: texture_2d<f32>;
@group(0) @binding(11) var plane_7: texture_2d<f32>;
@group(0) @binding(12) var plane_8: texture_2d<f32>;
@group(0) @binding(13) var plane_9: texture_2d<f32>;
@group(0) @binding(14) var plane_10: texture_2d<f32>;
@group(0) @binding(15) var plane_11: texture_2d<f32>;

const COLOUR: u32 = 1u;
const NORMAL: u32 = 2u;
const DIFFERENCE: u32 = 3u;
const RATIO: u32 = 4u;

const STRIPE: f32 = 4.0;
const CLIP_STRIPE = vec3<f32>(0.898, 0.224, 0.208);
const NEGATIVE_STRIPE = vec3<f32>(0.118, 0.533, 0.898);

// One triangle that covers the viewport; the scissor cuts it to the canvas.
@vertex
fn cover(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u));
    return vec4<f32>(4.0 * corner - 1.0, 0.0, 1.0);
}

// By its bits, because a compiler may assume that arithmetic never meets NaN or infinity.
fn is_finite(value: f32) -> bool {
    return (bitcast<u32>(value) & 0x7f800000u) != 0x7f800000u;
}

struct Values {
    sums: vec3<f32>,
    // False where any plane has no value.
    known: bool,
}

// The corners of the square of texels around a position, and where in it the position lies. R32Float textures are not filtered
// by every card, so it is done here.
struct Taps {
    first: vec2<i32>,
    second: vec2<i32>,
    part: vec2<f32>,
}

fn taps_at(texel: vec2<f32>) -> Taps {
    let last = vec2<i32>(textureDimensions(plane_0, i32(canvas.mip))) - 1;
    if canvas.nearest == 1u {
        let single = clamp(vec2<i32>(texel), vec2<i32>(0), last);
        return Taps(single, single, vec2<f32>(0.0));
    }
    let corner = floor(texel - 0.5);
    let first = clamp(vec2<i32>(corner), vec2<i32>(0), last);
    let second = clamp(vec2<i32>(corner) + 1, vec2<i32>(0), last);
    return Taps(first, second, texel - 0.5 - corner);
}

// Adds one plane, weighted, to the three sums.
fn with_plane(before: Values, plane: texture_2d<f32>, slot: u32, taps: Taps) -> Values {
    let mip = i32(canvas.mip);
    let a = textureLoad(plane, taps.first, mip).r;
    let b = textureLoad(plane, vec2<i32>(taps.second.x, taps.first.y), mip).r;
    let c = textureLoad(plane, vec2<i32>(taps.first.x, taps.second.y), mip).r;
    let d = textureLoad(plane, taps.second, mip).r;
    let value = mix(mix(a, b, taps.part.x), mix(c, d, taps.part.x), taps.part.y);
    let known = is_finite(a) && is_finite(b) && is_finite(c) && is_finite(d);
    return Values(before.sums + canvas.weights[slot].xyz * value, before.known && known);
}

// The three weighted sums of all planes at a position in texels. Bindings cannot be indexed everywhere, so they are spelt out.
fn sums_at(texel: vec2<f32>) -> Values {
    let taps = taps_at(texel);
    var sums = with_plane(Values(vec3<f32>(0.0), true), plane_0, 0u, taps);
    if PLANE_COUNT > 1u { sums = with_plane(sums, plane_1, 1u, taps); }
    if PLANE_COUNT > 2u { sums = with_plane(sums, plane_2, 2u, taps); }
    if PLANE_COUNT > 3u { sums = with_plane(sums, plane_3, 3u, taps); }
    if PLANE_COUNT > 4u { sums = with_plane(sums, plane_4, 4u, taps); }
    if PLANE_COUNT > 5u { sums = with_plane(sums, plane_5, 5u, taps); }
    if PLANE_COUNT > 6u { sums = with_plane(sums, plane_6, 6u, taps); }
    if PLANE_COUNT > 7u { sums = with_plane(sums, plane_7, 7u, taps); }
    if PLANE_COUNT > 8u { sums = with_plane(sums, plane_8, 8u, taps); }
    if PLANE_COUNT > 9u { sums = with_plane(sums, plane_9, 9u, taps); }
    if PLANE_COUNT > 10u { sums = with_plane(sums, plane_10, 10u, taps); }
    if PLANE_COUNT > 11u { sums = with_plane(sums, plane_11, 11u, taps); }
    return sums;
}

// The numbers that the picture shows at a position in texels.
fn values_at(texel: vec2<f32>) -> Values {
    var result = sums_at(texel);
    if KIND == DIFFERENCE {
        result.sums = vec3<f32>(result.sums.x - result.sums.y, 0.0, 0.0);
    } else if KIND == RATIO {
        result.known = result.known && result.sums.y != 0.0;
        result.sums = vec3<f32>(result.sums.x / result.sums.y, 0.0, 0.0);
    }
    return result;
}

// The target is in gamma space: nothing encodes for us.
fn encoded(linear: f32) -> f32 {
    if canvas.exponent != 0.0 {
        return pow(linear, canvas.exponent);
    }
    return select(1.055 * pow(linear, 1.0 / 2.4) - 0.055, 12.92 * linear, linear <= 0.0031308);
}

// Where a value lies on the colour map, 0 to 1.
fn position(value: f32) -> f32 {
    return clamp((value * canvas.gain - canvas.range.x) / (canvas.range.y - canvas.range.x), 0.0, 1.0);
}

fn mapped(value: f32) -> vec3<f32> {
    let along = position(value);
    if IS_GREY {
        return vec3<f32>(encoded(along));
    }
    let index = min(floor(along * 255.0), 254.0);
    let row = i32(canvas.map);
    let below = textureLoad(colour_maps, vec2<i32>(i32(index), row), 0).rgb;
    let above = textureLoad(colour_maps, vec2<i32>(i32(index) + 1, row), 0).rgb;
    return mix(below, above, along * 255.0 - index);
}

fn colour(values: vec3<f32>) -> vec3<f32> {
    if KIND == COLOUR {
        return vec3<f32>(encoded(position(values.x)), encoded(position(values.y)), encoded(position(values.z)));
    }
    if KIND == NORMAL {
        return clamp(0.5 * values + 0.5, vec3<f32>(0.0), vec3<f32>(1.0));
    }
    return mapped(values.x);
}

// Lays the tint of every set bit over the pixel, then lets the background through outside the mask.
fn tinted(pixel: vec3<f32>, texel: vec2<f32>) -> vec3<f32> {
    var result = pixel;
    let last = vec2<i32>(textureDimensions(plane_0, i32(canvas.mip))) - 1;
    let at = clamp(vec2<i32>(texel), vec2<i32>(0), last);
    if HAS_MARKS {
        let bits = textureLoad(marks, at, i32(canvas.mip)).r;
        for (var bit = 0u; bit < 8u; bit++) {
            if ((bits >> bit) & 1u) == 1u {
                result = mix(result, canvas.tints[bit].rgb, canvas.tints[bit].a);
            }
        }
    }
    if HAS_MASK && textureLoad(mask, at, i32(canvas.mip)).r == 0u {
        result = mix(result, canvas.background.rgb, canvas.mask_dimming);
    }
    return result;
}

fn on_stripe(along: f32) -> bool {
    let stripe = floor(along / STRIPE);
    return stripe - 2.0 * floor(0.5 * stripe) < 1.0;
}

// Warnings go over everything: too much light leans one way, less than none the other.
fn striped(pixel: vec3<f32>, values: vec3<f32>, target_px: vec2<f32>) -> vec3<f32> {
    // Of a single value the two other sums say nothing.
    var highest = values.x;
    var lowest = values.x;
    if KIND == COLOUR {
        highest = max(values.x, max(values.y, values.z));
        lowest = min(values.x, min(values.y, values.z));
    }
    if highest >= canvas.clip && on_stripe(target_px.x + target_px.y) {
        return CLIP_STRIPE;
    }
    if canvas.negative_zebra == 1u && lowest < 0.0 && on_stripe(target_px.x - target_px.y) {
        return NEGATIVE_STRIPE;
    }
    return pixel;
}

// Positions come from the target and not from the viewport, which egui cuts at the window's edge.
fn image_px(target_px: vec2<f32>) -> vec2<f32> {
    return (target_px - canvas.origin_px) / canvas.scale;
}

fn is_inside(at: vec2<f32>) -> bool {
    return all(at >= vec2<f32>(0.0)) && all(at < canvas.size);
}

// The colour of a pixel on the screen.
@fragment
fn show_colours(@builtin(position) target_px: vec4<f32>) -> @location(0) vec4<f32> {
    let at = image_px(target_px.xy);
    if !is_inside(at) {
        return canvas.background;
    }
    let texel = at / canvas.texel_size;
    let values = values_at(texel);
    if !values.known {
        return canvas.background;
    }
    let pixel = tinted(colour(values.sums), texel);
    return vec4<f32>(striped(pixel, values.sums, target_px.xy), 1.0);
}

// The numbers behind it, and 1 where there are any: the tests hold these to what the CPU computes and saves.
@fragment
fn show_values(@builtin(position) target_px: vec4<f32>) -> @location(0) vec4<f32> {
    let at = image_px(target_px.xy);
    if !is_inside(at) {
        return vec4<f32>(0.0);
    }
    let values = values_at(at / canvas.texel_size);
    return vec4<f32>(values.sums, f32(values.known));
}
