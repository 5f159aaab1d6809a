// The proxies that are asked about.

@group(1) @binding(0) var<storage, read> proxies: array<Proxy>;
