//! The one door between planner and interrupt: two static single-producer single-consumer rings.
