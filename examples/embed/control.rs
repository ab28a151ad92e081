//! The same as control.c in Rust: a mechanism with impacts in the loop of a controller, by the C functions of tlismni.h.
//!
//!     python make_image.py control.image
//!     rustc -O control.rs -C link-args="$(python -m tlismni.core.native)"
//!     ./control control.image

use std::convert::TryFrom;
use std::ffi::{c_char, c_int, c_long, c_void, CStr, CString};

#[repr(C)]
pub struct Model {
    _private: [u8; 0],
}
#[repr(C)]
pub struct Run {
    _private: [u8; 0],
}

#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct Event {
    time: f64,
    kind: c_int,
    contact: c_int,
    impulse: f64,
    energy_loss: f64,
    approach_speed: f64,
    separation_speed: f64,
    friction_impulse: f64,
    sliding_speed: f64,
}

const INPUT: c_int = 0;
const CHANNEL: c_int = 1;
const IMPACT: c_int = 0;
const STEP: f64 = 1e-3; // s

extern "C" {
    fn tlismni_open(path: *const c_char, why: *mut c_char, room: usize) -> *mut Model;
    fn tlismni_close(model: *mut Model);
    fn tlismni_find(model: *const Model, kind: c_int, name: *const c_char) -> c_long;
    fn tlismni_start(model: *const Model) -> *mut Run;
    fn tlismni_end(run: *mut Run);
    fn tlismni_time(run: *const Run) -> f64;
    fn tlismni_inputs(run: *mut Run) -> *mut f64;
    fn tlismni_channels(run: *const Run) -> *const f64;
    fn tlismni_step(run: *mut Run, t: f64, read: bool) -> c_int;
    fn tlismni_look(run: *mut Run) -> c_int;
    fn tlismni_events(run: *mut Run, events: *mut Event, room: usize) -> usize;
    fn tlismni_steps(run: *const Run) -> i64;
    fn tlismni_why(status: c_int) -> *const c_char;
    fn tlismni_state_size(model: *const Model) -> usize;
    fn tlismni_save(run: *const Run, bytes: *mut c_void);
    fn tlismni_restore(run: *mut Run, bytes: *const c_void) -> c_int;
}

/// A model and a run of it; both are given back when it goes.
struct Mechanism {
    model: *mut Model,
    run: *mut Run,
}

impl Mechanism {
    fn open(path: &str) -> Result<Mechanism, String> {
        let path = CString::new(path).map_err(|error| error.to_string())?;
        let mut why = [0 as c_char; 500];
        unsafe {
            let model = tlismni_open(path.as_ptr(), why.as_mut_ptr(), why.len());
            if model.is_null() {
                return Err(CStr::from_ptr(why.as_ptr()).to_string_lossy().into_owned());
            }
            let run = tlismni_start(model);
            if run.is_null() {
                tlismni_close(model);
                return Err("there is no memory left".into());
            }
            Ok(Mechanism { model, run })
        }
    }

    fn checked(&self, status: c_int) -> Result<(), String> {
        if status == 0 {
            return Ok(());
        }
        let why = unsafe { CStr::from_ptr(tlismni_why(status)) };
        Err(format!("at t = {:.6} s: {}", self.time(), why.to_string_lossy()))
    }

    fn number(&self, kind: c_int, name: &str) -> Result<usize, String> {
        let text = CString::new(name).map_err(|error| error.to_string())?;
        let found = unsafe { tlismni_find(self.model, kind, text.as_ptr()) };
        usize::try_from(found).map_err(|_| format!("the model has no '{name}'"))
    }

    fn time(&self) -> f64 {
        unsafe { tlismni_time(self.run) }
    }

    fn channel(&self, number: usize) -> f64 {
        unsafe { *tlismni_channels(self.run).add(number) }
    }

    /// Hold the crank's speed from step `first` to `last`; the number of impacts on the way.
    fn control(&mut self, first: u32, last: u32, gain: f64) -> Result<u32, String> {
        let torque = self.number(INPUT, "torque")?;
        let speed = self.number(CHANNEL, "crank.angular_velocity")?;
        let mut impacts = 0;
        for k in first..last {
            let mut events = [Event::default(); 8];
            let status = unsafe {
                *tlismni_inputs(self.run).add(torque) = gain * (6.0 - self.channel(speed));
                tlismni_step(self.run, f64::from(k + 1) * STEP, true)
            };
            self.checked(status)?;
            let found = unsafe { tlismni_events(self.run, events.as_mut_ptr(), events.len()) };
            for event in events.iter().take(found).filter(|event| event.kind == IMPACT) {
                impacts += 1;
                println!("  impact at {:.6} s, {:.3} N s", event.time, event.impulse);
            }
        }
        let steps = unsafe { tlismni_steps(self.run) };
        let (value, time) = (self.channel(speed), self.time());
        println!("  gain {gain}: {value:.6} rad/s at {time:.3} s, {steps} steps of the solver");
        Ok(impacts)
    }

    fn save(&self) -> Vec<u64> {
        // words, since the memory has to be aligned to 8 bytes
        let mut bytes = vec![0; unsafe { tlismni_state_size(self.model) }.div_ceil(8)];
        unsafe { tlismni_save(self.run, bytes.as_mut_ptr().cast()) };
        bytes
    }

    fn restore(&mut self, bytes: &[u64]) -> Result<(), String> {
        let status = unsafe { tlismni_restore(self.run, bytes.as_ptr().cast()) };
        self.checked(status)?;
        let status = unsafe { tlismni_look(self.run) };
        self.checked(status)
    }
}

impl Drop for Mechanism {
    fn drop(&mut self) {
        unsafe {
            tlismni_end(self.run);
            tlismni_close(self.model);
        }
    }
}

fn main() -> Result<(), String> {
    let path = std::env::args().nth(1).ok_or("name an image")?;
    let mut mechanism = Mechanism::open(&path)?;
    let status = unsafe { tlismni_look(mechanism.run) };
    mechanism.checked(status)?;
    mechanism.control(0, 150, 2.0)?;
    let kept = mechanism.save();
    let gentle = mechanism.control(150, 300, 2.0)?;
    mechanism.restore(&kept)?;
    let firm = mechanism.control(150, 300, 20.0)?;
    println!("{gentle} impacts, and {firm} with the other gain");
    Ok(())
}
