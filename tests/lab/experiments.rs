//! The lab's experiments against its exact values: mean and variance, drawn both ways, from fixed seeds.

use photonvdb::lab::{BiasRequest, BiasRow, BiasTable, Constant, Experiment, Method, Model};

/// |z| that 1 of 150 000 standard normal numbers exceeds.
const LIMIT: f64 = 4.5;

fn request(models: &[Model], trials: u64, method: Method) -> BiasRequest {
    BiasRequest {
        models: models.to_vec(),
        n: None,
        ks: (2..=100).collect(),
        constants: vec![Constant::K],
        trials,
        method,
        seed: 3,
    }
}

fn check(table: &BiasTable) {
    // Below k = 5 the fourth moment of a random model is infinite: its errors are not normal.
    for row in table.rows.iter().filter(|row| row.k >= 5) {
        let BiasRow { model, k, .. } = row;
        if let Some(z) = row.z {
            assert!(z.abs() < LIMIT, "{model} k = {k}: z = {z}");
        }
        let (Some(exact), Some(measured), Some(error)) =
            (row.exact_variance, row.measured_variance, row.variance_std_error)
        else {
            continue;
        };
        let is_near = (measured - exact).abs() <= LIMIT * error + 0.02 * exact;
        assert!(is_near, "{model} k = {k}: variance {measured} instead of {exact} +- {error}");
    }
    assert!(table.rows.iter().filter(|row| row.z.is_some()).count() > 90);
}

#[test]
fn order_statistics_alone_give_the_exact_moments() {
    for model in Model::ALL {
        if !matches!(model, Model::FirstApproximation | Model::FixedRadius | Model::Jittered(2 | 3))
        {
            check(&request(&[model], 20_000, Method::Fast).tabulate(|_| ()).unwrap());
        }
    }
}

#[test]
fn all_photons_placed_give_the_exact_moments() {
    for model in Model::ALL {
        if !matches!(model, Model::FirstApproximation | Model::FixedRadius | Model::Jittered(2 | 3))
        {
            check(&request(&[model], 2_000, Method::Direct).tabulate(|_| ()).unwrap());
        }
    }
}

#[test]
fn odd_numbers_of_photons_are_stratified_too() {
    for method in [Method::Fast, Method::Direct] {
        let odd = BiasRequest { n: Some(1001), ..request(&[Model::Stratified], 4_000, method) };
        check(&odd.tabulate(|_| ()).unwrap());
    }
}

#[test]
fn a_fixed_radius_counts_without_bias() {
    let mut moments = Vec::new();
    for method in [Method::Fast, Method::Direct] {
        for n in [1000, 1001] {
            let ks = [2, 3, 10, 11];
            let experiment = Experiment {
                model: Model::FixedRadius,
                n,
                ks: &ks,
                trials: 20_000,
                method,
                seed: 1,
            };
            let measured = experiment.run().unwrap().unwrap().moments;
            for (moments, k) in measured.iter().zip(ks) {
                let exact = if n % 2 == k % 2 { 0.0 } else { 0.5 / (k * k) as f64 };
                let error = (exact / 20_000.0).sqrt();
                assert!(moments.bias().abs() <= LIMIT * error, "{n} {k}");
                let variance_error = LIMIT * moments.variance_std_error();
                assert!((moments.variance() - exact).abs() <= variance_error, "{n} {k}");
            }
            moments.push(measured);
        }
    }
}

/// Grids of two and three dimensions have no exact law: both ways of drawing must agree, and with the law of
/// counts that vary on the surface alone, E\[k/u\] = k / (k - 1/2 - g/2), to 3 % of the bias.
#[test]
fn jittered_grids_agree_with_the_law_of_their_surface() {
    for (dimension, constant) in [(2, 0.588343028393482), (3, 0.799999990297198)] {
        let ks: Vec<u64> = vec![2, 5, 10, 20, 50, 100];
        let experiment = |method, trials| {
            let model = Model::Jittered(dimension);
            let n = model.nearest_count(model.photons_needed(100));
            Experiment { model, n, ks: &ks, trials, method, seed: 5 }
                .run()
                .unwrap()
                .unwrap()
                .moments
        };
        let (fast, direct) = (experiment(Method::Fast, 60_000), experiment(Method::Direct, 8_000));
        for (index, &k) in ks.iter().enumerate() {
            let (fast, direct) = (&fast[index], &direct[index]);
            let error = fast.std_error().hypot(direct.std_error());
            let z = (fast.bias() - direct.bias()) / error;
            assert!(z.abs() < LIMIT, "{dimension}-D, k = {k}: z = {z}");
            if k >= 10 {
                let (d, k) = (f64::from(dimension), k as f64);
                let g = (d + 1.0) / d * constant * k.powf(-1.0 / d);
                let law = k / (k - 0.5 - 0.5 * g) - 1.0;
                let difference = (fast.bias() - law).abs();
                assert!(
                    difference < 0.03 * law + 4.0 * fast.std_error(),
                    "{dimension}-D, k = {k}: {} instead of {law}",
                    fast.bias()
                );
            }
        }
    }
}

#[test]
fn tables_are_the_same_for_any_number_of_threads() {
    let models = [Model::Random(2), Model::Order(3), Model::Jittered(2), Model::Stratified];
    let tables = [1, 2, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| request(&models, 1_000, Method::Fast).tabulate(|_| ()).unwrap().to_csv())
    });
    assert_eq!(tables[0], tables[1]);
    assert_eq!(tables[0], tables[2]);
    let other = BiasRequest { seed: 4, ..request(&models, 1_000, Method::Fast) };
    assert_ne!(other.tabulate(|_| ()).unwrap().to_csv(), tables[0]);
}
