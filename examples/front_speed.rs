//! Measures the speed of the Pareto filter and of the hypervolume on a file of points, for a comparison with other
//! programs. `benches/peers/moocore_front.py` runs this example.
//!
//! `front_speed POINTS A,B,C MASK REPEATS` reads points from the file POINTS (three little-endian `f64` for each
//! point). Filter and hypervolume are computed REPEATS times. The file MASK then gets one byte for each point: 1 if no
//! other point dominates it, otherwise 0.
//!
//! Three numbers are printed: the least processor time of the filter \[s\], the least processor time of the hypervolume
//! \[s\], and the hypervolume below the reference point A,B,C. Processor times are summed over all threads.

use armwright::pareto::front::exact_front;
use armwright::pareto::hypervolume::hypervolume;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [file, reference, mask, repeats] = words.as_slice() else {
        return Err("usage: front_speed POINTS A,B,C MASK REPEATS".into());
    };
    let bytes = std::fs::read(file)?;
    let points: Vec<[f64; 3]> = bytes
        .chunks_exact(24)
        .map(|row| {
            std::array::from_fn(|k| f64::from_le_bytes(row[8 * k..][..8].try_into().unwrap_or_default()))
        })
        .collect();
    let reference: Vec<f64> = reference.split(',').map(str::parse).collect::<Result<_, _>>()?;
    let reference: [f64; 3] = reference.try_into().map_err(|_| "the reference point has three numbers")?;
    let (mut filter_s, mut volume_s) = (f64::INFINITY, f64::INFINITY);
    let (mut front, mut volume) = (Vec::new(), 0.0);
    for _ in 0..repeats.parse::<u32>()? {
        let started = processor_s();
        front = exact_front(&points)?;
        filter_s = filter_s.min(processor_s() - started);
        let started = processor_s();
        volume = hypervolume(&points, reference)?;
        volume_s = volume_s.min(processor_s() - started);
    }
    let mut on_front = vec![0u8; points.len()];
    front.iter().for_each(|&i| on_front[i] = 1);
    std::fs::write(mask, on_front)?;
    println!("{filter_s} {volume_s} {volume}");
    Ok(())
}

/// Processor time of all threads of this process so far \[s\].
fn processor_s() -> f64 {
    let tasks = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let spent = tasks.filter_map(|task| std::fs::read_to_string(task.path().join("schedstat")).ok());
    spent.filter_map(|s| s.split(' ').next()?.parse::<f64>().ok()).sum::<f64>() / 1e9
}
