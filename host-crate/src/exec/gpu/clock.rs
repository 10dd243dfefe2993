//! The device's clock: how long each part of a run takes.

use std::time::Duration;

/// Parts of a run that can be timed, at most.
const MOST_PARTS: u32 = wgpu::QUERY_SET_MAX_QUERIES / 2;
/// Two time stamps of a part.
const STAMP_BYTES: u64 = 16;

/// Two time stamps for each part of a run.
pub struct Clock {
    parts: u32,
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    staging: wgpu::Buffer,
}

impl Clock {
    /// A clock for runs of up to `parts` parts.
    pub fn new(device: &wgpu::Device, parts: u32) -> Self {
        let buffer = |label, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: u64::from(parts) * STAMP_BYTES,
                usage,
                mapped_at_creation: false,
            })
        };
        Self {
            parts,
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("parts of a run"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * parts,
            }),
            resolved: buffer(
                "timestamps",
                wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            ),
            staging: buffer(
                "timestamps",
                wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            ),
        }
    }

    /// This clock, made larger if need be; nothing if no clock can time so many parts.
    pub fn with_room_for(&mut self, device: &wgpu::Device, parts: u32) -> Option<&Self> {
        if parts > MOST_PARTS {
            return None;
        }
        if parts > self.parts {
            // Twice the number, so that little is made over and over while runs get longer.
            *self = Self::new(device, (2 * parts).min(MOST_PARTS));
        }
        Some(self)
    }

    /// Where the pass that is part `number` of a run leaves its stamps.
    pub fn stamps(&self, number: u32) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(2 * number),
            end_of_pass_write_index: Some(2 * number + 1),
        }
    }

    /// Has the stamps of the first `parts` parts copied to a staging buffer, after what `encoder`
    /// has so far. Returns that and their bytes.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder, parts: u32) -> (&wgpu::Buffer, u64) {
        let bytes = u64::from(parts) * STAMP_BYTES;
        encoder.resolve_query_set(&self.queries, 0..2 * parts, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.staging, 0, bytes);
        (&self.staging, bytes)
    }
}

/// The time of each part, of their stamps in units of `period` nanoseconds.
pub fn durations(stamps: &[u8], period: f32) -> Vec<Duration> {
    let stamps: Vec<[u64; 2]> = bytemuck::pod_collect_to_vec(stamps);
    stamps
        .into_iter()
        .map(|[start, end]| {
            Duration::from_nanos((end.saturating_sub(start) as f64 * f64::from(period)) as u64)
        })
        .collect()
}
