//! How fast the Pareto filter and the hypervolume are on a file of points, for a comparison with other programs.
//!
//! `front_speed POINTS A,B,C MASK REPEATS` reads points (three little-endian `f64` each), writes one byte a point to MASK
//! (1 if nothing dominates it) and prints the least processor seconds, all threads together, of so many repeats: filter,
//! then hypervolume below the reference point; and the hypervolume. `benches/peers/moocore_front.py` runs it.

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

/// Time that the threads of this process have been on a processor \[s\].
fn processor_s() -> f64 {
    let tasks = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let spent = tasks.filter_map(|task| std::fs::read_to_string(task.path().join("schedstat")).ok());
    spent.filter_map(|s| s.split(' ').next()?.parse::<f64>().ok()).sum::<f64>() / 1e9
}
