// What is found of each proxy: the twin of the struct in src/query/gpu/pack.rs.

struct Count {
    visible: atomic<u32>,
    total: atomic<u32>,
}

@group(1) @binding(1) var<storage, read_write> counts: array<Count>;
