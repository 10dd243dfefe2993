//! Messages on their way.

use crate::post::Address;
use mpi::Count;
use mpi::point_to_point::{Destination, Message, Status};
use mpi::request::{Request, StaticScope};
use mpi::topology::{Communicator, SimpleCommunicator};
use mpi::traits::Equivalence;

/// A message that is being sent or received.
pub struct Transfer {
    request: Request<'static, [u8], StaticScope>,
    bytes: *mut [u8],
    /// Whom it goes to or comes from.
    pub with: Address,
}

impl Transfer {
    /// Begins to send `bytes`.
    pub fn send(world: &SimpleCommunicator, to: Address, bytes: Vec<u8>) -> Self {
        let bytes = Box::into_raw(bytes.into_boxed_slice());
        // SAFETY: the bytes have just been leaked, and nobody writes to them or frees them before
        // the request is complete.
        let content: &'static [u8] = unsafe { &*bytes };
        let process = world.process_at_rank(to.rank);
        let request = process.immediate_send_with_tag(StaticScope, content, to.worker);
        Self { request, bytes, with: to }
    }

    /// Begins to receive a message that has been announced.
    pub fn receive(message: Message, status: &Status) -> Self {
        let length: Count = status.count(u8::equivalent_datatype());
        let bytes = Box::into_raw(vec![0; length.max(0) as usize].into_boxed_slice());
        // SAFETY: the bytes have just been leaked, and nobody but MPI looks at them or frees them
        // before the request is complete.
        let content: &'static mut [u8] = unsafe { &mut *bytes };
        let request = message.immediate_matched_receive_into(StaticScope, content);
        let with = Address { rank: status.source_rank(), worker: status.tag() };
        Self { request, bytes, with }
    }

    /// The bytes if it is complete, or else the transfer.
    pub fn completed(self) -> Result<Vec<u8>, Self> {
        let Self { request, bytes, with } = self;
        match request.test() {
            // SAFETY: the pointer is that of a box which was leaked; MPI has done with it, and the
            // request, which had the only reference to it, is gone.
            Ok(_) => Ok(unsafe { Box::from_raw(bytes) }.into_vec()),
            Err(request) => Err(Self { request, bytes, with }),
        }
    }

    /// Gives up what will never be complete. Its bytes stay where they are: MPI may still look at
    /// them.
    pub fn give_up(self) {
        std::mem::forget(self.request);
    }
}
