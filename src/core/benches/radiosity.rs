//! Cost of form factors with visibility against the number of patches, on a scene where things stand in the way.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use firstbounce_core::{
    Unwatched,
    radiosity::{FormFactorOptions, Patches, form_factors},
    scene::Shape,
};

fn form_factors_with_visibility(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("form factors with visibility");
    group.sample_size(10);
    for patches in [2_500, 5_000, 10_000] {
        let mesh = Shape::Tray { side_mm: 80.0 }.mesh(patches).expect("a tray has patches");
        let patches = Patches::from_mesh(&mesh).expect("its mesh is whole");
        group.bench_with_input(BenchmarkId::from_parameter(patches.len()), &patches, |bench, patches| {
            bench.iter(|| form_factors(patches.clone(), &FormFactorOptions::default(), &Unwatched));
        });
    }
    group.finish();
}

criterion_group!(benches, form_factors_with_visibility);
criterion_main!(benches);
