//! The tests' own statistics.

use raystream_tests::statistics::{chi_square_quantile, normal_quantile};

#[test]
fn quantiles_are_those_of_the_tables() {
    for (probability, expected) in
        [(0.5, 0.0), (0.6, 0.253_347), (0.975, 1.959_964), (1.0 - 1e-5, 4.264_891)]
    {
        assert!((normal_quantile(probability) - expected).abs() < 1e-5, "{probability}");
    }
    assert!((chi_square_quantile(0.99, 10.0) / 23.209 - 1.0).abs() < 0.01);
}
