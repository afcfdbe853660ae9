// Turns planes of linear light into the colours of a canvas. `colour.rs` and `twin.rs` say the same in Rust.

// Field by field the `Uniforms` of uniforms.rs, where units are given.
struct Canvas {
    origin_px: vec2<f32>,
    scale: f32,
    texel_size: f32,
    size: vec2<f32>,
    mip: u32,
    plane_count: u32,
    kind: u32,
    map: u32,
    exponent: f32,
    gain: f32,
    range: vec2<f32>,
    clip: f32,
    negative_zebra: u32,
    mask_dimming: f32,
    has_marks: u32,
    has_mask: u32,
    nearest: u32,
    background: vec4<f32>,
    tints: array<vec4<f32>, 8>,
    weights: array<vec4<f32>, 12>,
}

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
const GREY: u32 = 0u;

const STRIPE: f32 = 4.0;
const CLIP_STRIPE = vec3<f32>(0.898, 0.224, 0.208);
const NEGATIVE_STRIPE = vec3<f32>(0.118, 0.533, 0.898);

// One triangle that covers the viewport; the scissor cuts it to the canvas.
@vertex
fn cover(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u));
    return vec4<f32>(4.0 * corner - 1.0, 0.0, 1.0);
}

// Bindings cannot be indexed everywhere, so the slot is spelt out.
fn load(slot: u32, at: vec2<i32>) -> f32 {
    let mip = i32(canvas.mip);
    switch slot {
        case 0u: { return textureLoad(plane_0, at, mip).r; }
        case 1u: { return textureLoad(plane_1, at, mip).r; }
        case 2u: { return textureLoad(plane_2, at, mip).r; }
        case 3u: { return textureLoad(plane_3, at, mip).r; }
        case 4u: { return textureLoad(plane_4, at, mip).r; }
        case 5u: { return textureLoad(plane_5, at, mip).r; }
        case 6u: { return textureLoad(plane_6, at, mip).r; }
        case 7u: { return textureLoad(plane_7, at, mip).r; }
        case 8u: { return textureLoad(plane_8, at, mip).r; }
        case 9u: { return textureLoad(plane_9, at, mip).r; }
        case 10u: { return textureLoad(plane_10, at, mip).r; }
        default: { return textureLoad(plane_11, at, mip).r; }
    }
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

// The three weighted sums of all planes at a position in texels.
fn sums_at(texel: vec2<f32>) -> Values {
    let last = vec2<i32>(textureDimensions(plane_0, i32(canvas.mip))) - 1;
    // Four texels and their shares; R32Float textures are not filtered by every card, so it is done here.
    let corner = floor(texel - 0.5);
    let part = texel - 0.5 - corner;
    let first = clamp(vec2<i32>(corner), vec2<i32>(0), last);
    let second = clamp(vec2<i32>(corner) + 1, vec2<i32>(0), last);
    let single = clamp(vec2<i32>(texel), vec2<i32>(0), last);

    var result = Values(vec3<f32>(0.0), true);
    for (var slot = 0u; slot < canvas.plane_count; slot++) {
        var value: f32;
        if canvas.nearest == 1u {
            value = load(slot, single);
            result.known = result.known && is_finite(value);
        } else {
            let a = load(slot, first);
            let b = load(slot, vec2<i32>(second.x, first.y));
            let c = load(slot, vec2<i32>(first.x, second.y));
            let d = load(slot, second);
            result.known = result.known && is_finite(a) && is_finite(b) && is_finite(c) && is_finite(d);
            value = mix(mix(a, b, part.x), mix(c, d, part.x), part.y);
        }
        result.sums += canvas.weights[slot].xyz * value;
    }
    return result;
}

// The numbers that the picture shows at a position in texels.
fn values_at(texel: vec2<f32>) -> Values {
    var result = sums_at(texel);
    if canvas.kind == DIFFERENCE {
        result.sums = vec3<f32>(result.sums.x - result.sums.y, 0.0, 0.0);
    } else if canvas.kind == RATIO {
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
    if canvas.map == GREY {
        return vec3<f32>(encoded(along));
    }
    let index = min(floor(along * 255.0), 254.0);
    let row = i32(canvas.map);
    let below = textureLoad(colour_maps, vec2<i32>(i32(index), row), 0).rgb;
    let above = textureLoad(colour_maps, vec2<i32>(i32(index) + 1, row), 0).rgb;
    return mix(below, above, along * 255.0 - index);
}

fn colour(values: vec3<f32>) -> vec3<f32> {
    if canvas.kind == COLOUR {
        return vec3<f32>(encoded(position(values.x)), encoded(position(values.y)), encoded(position(values.z)));
    }
    if canvas.kind == NORMAL {
        return clamp(0.5 * values + 0.5, vec3<f32>(0.0), vec3<f32>(1.0));
    }
    return mapped(values.x);
}

// Lays the tint of every set bit over the pixel, then lets the background through outside the mask.
fn tinted(pixel: vec3<f32>, texel: vec2<f32>) -> vec3<f32> {
    var result = pixel;
    let last = vec2<i32>(textureDimensions(plane_0, i32(canvas.mip))) - 1;
    let at = clamp(vec2<i32>(texel), vec2<i32>(0), last);
    if canvas.has_marks == 1u {
        let bits = textureLoad(marks, at, i32(canvas.mip)).r;
        for (var bit = 0u; bit < 8u; bit++) {
            if ((bits >> bit) & 1u) == 1u {
                result = mix(result, canvas.tints[bit].rgb, canvas.tints[bit].a);
            }
        }
    }
    if canvas.has_mask == 1u && textureLoad(mask, at, i32(canvas.mip)).r == 0u {
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
    if canvas.kind == COLOUR {
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
