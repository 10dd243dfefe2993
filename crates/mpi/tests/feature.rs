//! Says what is left out of a run of the tests.

/// Without the feature `mpi` there is no program to test.
#[test]
fn processes_are_tested_with_the_feature_mpi() {
    if cfg!(feature = "mpi") {
        return;
    }
    let variable = "RAYSTREAM_REQUIRE_MPI";
    let is_required = std::env::var_os(variable).is_some();
    assert!(!is_required, "{variable} is set: add --features raystream-mpi/mpi");
    raystream_tests::not_tested("several processes: --features raystream-mpi/mpi is not given");
}
