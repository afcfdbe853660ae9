// Draws one layer of the 3D view. Colours are in gamma space where nothing else is said.

struct Layer {
    clip_from_local: mat4x4<f32>,
    world_from_local: mat4x4<f32>,
    // Rows: right, up, toward the eye.
    view_from_world: mat4x4<f32>,
    // Position and 1, or direction to it and 0.
    eye: vec4<f32>,
    lamp: vec4<f32>,
    // The layer's own colour; the fourth is 1 where it is used instead of the vertices' colours.
    base: vec4<f32>,
    // The fourth is how much of the surface an edge covers.
    line: vec4<f32>,
    // Unit normal and offset of the section plane; the colour's fourth is half the width of its line in pixels, 0 for none.
    plane: vec4<f32>,
    plane_colour: vec4<f32>,
    // Values at the two ends of the colour map.
    range: vec2<f32>,
    map: u32,
    shading: u32,
}

const PLAIN = 0u;
const HEADLIGHT = 1u;
const LAMP = 2u;
const NORMALS = 3u;
const ALBEDO = 4u;
const HEIGHT = 5u;
const MATCAP = 6u;
const DISTANCE = 7u;

// Values from here on stand for none.
const NO_VALUE = 1e20;
const NO_COUNTERPART = vec3<f32>(0.48, 0.48, 0.48);
// Lines lie this much nearer than the surface they are on, in clip space.
const LIFT = 2e-4;

@group(0) @binding(0) var<uniform> layer: Layer;
@group(0) @binding(1) var colour_maps: texture_2d<f32>;

struct Between {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) colour: vec4<f32>,
    @location(3) value: f32,
}

fn placed(position: vec3<f32>, normal: vec3<f32>, colour: vec4<f32>, value: f32) -> Between {
    var out: Between;
    out.clip = layer.clip_from_local * vec4(position, 1.0);
    out.world = (layer.world_from_local * vec4(position, 1.0)).xyz;
    out.normal = (layer.world_from_local * vec4(normal, 0.0)).xyz;
    out.colour = colour;
    out.value = value;
    return out;
}

@vertex
fn surface(
    @location(0) position: vec3<f32>, @location(1) normal: vec4<f32>, @location(2) colour: vec4<f32>,
) -> Between {
    return placed(position, normal.xyz, colour, 2.0 * NO_VALUE);
}

@vertex
fn surface_with_values(
    @location(0) position: vec3<f32>, @location(1) normal: vec4<f32>, @location(2) colour: vec4<f32>,
    @location(3) value: f32,
) -> Between {
    return placed(position, normal.xyz, colour, value);
}

@vertex
fn lifted(
    @location(0) position: vec3<f32>, @location(1) normal: vec4<f32>, @location(2) colour: vec4<f32>,
) -> @builtin(position) vec4<f32> {
    var clip = layer.clip_from_local * vec4(position, 1.0);
    clip.z -= LIFT * clip.w;
    return clip;
}

@fragment
fn wire() -> @location(0) vec4<f32> {
    return layer.line;
}

fn encoded(light: vec3<f32>) -> vec3<f32> {
    let clamped = clamp(light, vec3(0.0), vec3(1.0));
    let curved = 1.055 * pow(clamped, vec3(1.0 / 2.4)) - 0.055;
    return select(curved, 12.92 * clamped, clamped <= vec3(0.0031308));
}

fn decoded(colour: vec3<f32>) -> vec3<f32> {
    return select(pow((colour + 0.055) / 1.055, vec3(2.4)), colour / 12.92, colour <= vec3(0.04045));
}

fn mapped(value: f32) -> vec3<f32> {
    let span = max(layer.range.y - layer.range.x, 1e-30);
    let at = 255.0 * clamp((value - layer.range.x) / span, 0.0, 1.0);
    let below = i32(min(floor(at), 254.0));
    let low = textureLoad(colour_maps, vec2(below, i32(layer.map)), 0).rgb;
    let high = textureLoad(colour_maps, vec2(below + 1, i32(layer.map)), 0).rgb;
    return mix(low, high, at - f32(below));
}

// Matter lit by a soft light from above left and a bluish one from behind, by the normal in the eye's frame alone.
fn matter(base: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    let key = max(dot(normal, normalize(vec3(-0.45, 0.65, 0.62))), 0.0);
    let sky = 0.5 + 0.5 * normal.y;
    let rim = pow(1.0 - clamp(normal.z, 0.0, 1.0), 2.5);
    let gloss = pow(max(dot(normal, normalize(vec3(-0.28, 0.4, 0.87))), 0.0), 40.0);
    let light = 0.72 * key + 0.22 * sky + 0.05;
    return base * light + vec3(0.20, 0.26, 0.34) * rim * 0.5 + vec3(0.28) * gloss;
}

@fragment
fn shade(in: Between, @builtin(front_facing) is_front: bool) -> @location(0) vec4<f32> {
    // Both sides are lit: a surface seen from behind shows its normal from there.
    let outward = normalize(in.normal);
    let normal = select(-outward, outward, is_front);
    let to_eye = normalize(layer.eye.xyz - in.world * layer.eye.w);
    let has_colour = in.colour.a > 0.5;
    let albedo = select(vec3(0.72), in.colour.rgb, has_colour);
    let base = select(vec3(0.80, 0.79, 0.76), layer.base.rgb, layer.base.a > 0.5);

    var colour = base;
    switch layer.shading {
        case HEADLIGHT: {
            colour = encoded(decoded(base) * (0.06 + 0.94 * max(dot(normal, to_eye), 0.0)));
        }
        case LAMP: {
            let own = select(albedo, layer.base.rgb, layer.base.a > 0.5);
            let to_lamp = normalize(layer.lamp.xyz - in.world * layer.lamp.w);
            colour = encoded(decoded(own) * max(dot(normal, to_lamp), 0.0));
        }
        case NORMALS: {
            colour = 0.5 + 0.5 * normal;
        }
        case ALBEDO: {
            colour = albedo;
        }
        case HEIGHT: {
            let light = 0.75 + 0.25 * max(dot(normal, to_eye), 0.0);
            colour = mapped(in.world.z) * light;
        }
        case MATCAP: {
            let seen = (layer.view_from_world * vec4(normal, 0.0)).xyz;
            colour = encoded(matter(decoded(base), seen));
        }
        case DISTANCE: {
            let light = 0.75 + 0.25 * max(dot(normal, to_eye), 0.0);
            colour = select(mapped(in.value), NO_COUNTERPART, abs(in.value) > NO_VALUE) * light;
        }
        default: {}
    }
    // What is seen from behind is a little darker: nobody takes the inside for the outside.
    colour = select(0.72 * colour, colour, is_front);

    let from_plane = dot(layer.plane.xyz, in.world) - layer.plane.w;
    let per_pixel = max(fwidth(from_plane), 1e-12);
    let line = clamp(layer.plane_colour.a + 0.5 - abs(from_plane) / per_pixel, 0.0, 1.0);
    let is_cut = select(0.0, line, layer.plane_colour.a > 0.0);
    return vec4(mix(colour, layer.plane_colour.rgb, is_cut), 1.0);
}

// Lays the finished picture into the window.

struct Place {
    origin_px: vec2<f32>,
    unused: vec2<f32>,
}

@group(0) @binding(0) var<uniform> place: Place;
@group(0) @binding(1) var picture: texture_2d<f32>;

@vertex
fn cover(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4(corner * 2.0 - 1.0, 0.0, 1.0);
}

@fragment
fn copy(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let last = vec2<i32>(textureDimensions(picture)) - 1;
    let texel = clamp(vec2<i32>(floor(at.xy - place.origin_px)), vec2(0), last);
    return textureLoad(picture, texel, 0);
}
