//! Integrators: the contribution of every slot is that of the megakernel, bit for bit on the CPU,
//! whatever the stream and the pool; on the GPU as far as its compiler treats two kernels alike.

mod abilities;
mod cameras;
mod devices;
mod emission_maps;
mod environment;
mod instances;
mod instructions;
mod layer_maps;
mod light_tree;
mod lvc;
mod memory;
mod pixel_filters;
mod punctual_lights;
mod renders;
mod slots;
mod techniques;
mod tracing;
mod vertex_colours;
mod wide_textures;
mod wrapping;
