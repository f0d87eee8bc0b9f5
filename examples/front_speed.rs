//! How fast the Pareto filter and the hypervolume are on a file of points, for a comparison with other programs.
//!
//! `front_speed POINTS A,B,C MASK REPEATS` reads points (three little-endian `f64` each), writes one byte a point to MASK
//! (1 if nothing dominates it) and prints the least seconds of so many repeats, filter and hypervolume below the
//! reference point, and the hypervolume. `benches/peers/moocore_front.py` runs it.

use armwright::search::front::exact_front;
use armwright::search::hypervolume::hypervolume;
use std::time::Instant;

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
        let started = Instant::now();
        front = exact_front(&points)?;
        filter_s = filter_s.min(started.elapsed().as_secs_f64());
        let started = Instant::now();
        volume = hypervolume(&points, reference)?;
        volume_s = volume_s.min(started.elapsed().as_secs_f64());
    }
    let mut on_front = vec![0u8; points.len()];
    front.iter().for_each(|&i| on_front[i] = 1);
    std::fs::write(mask, on_front)?;
    println!("{filter_s} {volume_s} {volume}");
    Ok(())
}
